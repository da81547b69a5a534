//! `kajo view` as a user or a script starts it.

mod common;

use common::{json, kajo, run, succeed};
use kajo_image::ExrFile;
use std::process::{Child, Command, Stdio};

fn stderr(output: &std::process::Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// The command that the viewer gives for a moved camera renders the picture that the viewer shows.
#[test]
fn the_command_in_a_saved_picture_repeats_it() {
    let folder = tempfile::tempdir().unwrap();
    let script = "coarseness 4\npicture\ntechnique shadow/map:resolution=256\norbit 40 -12\nfly 0.1,0,-0.2\npicture\nsave seen.exr";
    std::fs::write(folder.path().join("steps"), script).unwrap();
    succeed(folder.path(), &["view", "builtin:shadows", "--offscreen", "--size", "640x300", "--script", "steps"]);
    let command = ExrFile::read(&folder.path().join("seen.exr")).unwrap().metadata["command"].clone();
    assert!(command.contains("--look-from=") && command.contains("shadow/map:resolution=256"), "{command}");
    let words: Vec<&str> = command.split(' ').skip(1).map(|word| if word == "kajo.png" { "repeated.exr" } else { word }).collect();
    succeed(folder.path(), &words);
    let metrics = json(folder.path(), &["metrics", "repeated.exr", "seen.exr"]);
    // Not identical: the place passes through text and angles through a target. A border of a shadow may fall on the other side of a pixel.
    assert!(metrics["rmse"].as_f64().unwrap() < 2e-2 && metrics["flip"].as_f64().unwrap() < 2e-3, "{metrics}");
    let size = ExrFile::read(&folder.path().join("seen.exr")).unwrap().color("").unwrap().size();
    let words = ["render", "builtin:shadows", "--renderer", "realtime", "--size", &format!("{}x{}", size.x, size.y), "-o", "other.exr"];
    succeed(folder.path(), &words);
    let unmoved = json(folder.path(), &["metrics", "other.exr", "seen.exr"]);
    assert!(unmoved["flip"].as_f64().unwrap() > 0.05, "the scene's own camera is another picture: {unmoved}");
}

#[test]
fn a_step_that_fails_is_told_with_its_line_and_exit_code_1() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("steps"), "open /no/such/scene.glb\nwait\nexpect quiet").unwrap();
    let output = run(folder.path(), &["view", "--offscreen", "--script", "steps"]);
    assert!(
        output.status.code() == Some(1) && stderr(&output).starts_with("error: steps: line 3: there are messages: "),
        "{}",
        stderr(&output)
    );
}

#[test]
fn a_picture_of_nothing_is_not_waited_for() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("cut.glb"), b"glTF\x02\0\0\0").unwrap();
    for (words, says) in [(&["no.glb"][..], "no.glb"), (&["cut.glb"], "cut.glb"), (&[], "there is no scene to see")] {
        let output = run(folder.path(), &[&["view", "--offscreen", "--frames", "1", "--screenshot", "a.png"], words].concat());
        let said = stderr(&output);
        assert!(output.status.code() == Some(1) && said.starts_with("error: ") && said.contains(says), "{said}");
        assert!(said.lines().count() == 1 && !said.contains("line 0") && !folder.path().join("a.png").exists(), "{said}");
    }
}

/// On systems where a window needs a display that can be taken away.
#[test]
#[cfg(target_os = "linux")]
fn without_a_display_one_sentence_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let mut command = kajo(folder.path());
    for name in ["DISPLAY", "WAYLAND_DISPLAY", "WAYLAND_SOCKET"] {
        command.env_remove(name);
    }
    let output = command.args(["view", "builtin:cornell"]).output().unwrap();
    assert!(
        output.status.code() == Some(1) && stderr(&output).starts_with("error: no window can be opened: neither WAYLAND_DISPLAY"),
        "{}",
        stderr(&output)
    );
}

/// A display that nobody sees; ended when it is dropped.
struct Display {
    server: Child,
    name: String,
}

impl Drop for Display {
    fn drop(&mut self) {
        let _ = self.server.kill();
        let _ = self.server.wait();
    }
}

/// Starts Xvfb on a number that it finds itself; `None` where it is not installed.
fn display() -> Option<Display> {
    use std::io::{BufRead, BufReader};
    let server =
        Command::new("Xvfb").args(["-displayfd", "1", "-screen", "0", "1280x800x24"]).stdout(Stdio::piped()).stderr(Stdio::null()).spawn();
    let Ok(mut server) = server else {
        eprintln!("skipped: there is no Xvfb; `cargo xtask setup` installs it");
        return None;
    };
    let mut line = String::new();
    BufReader::new(server.stdout.take()?).read_line(&mut line).ok()?;
    Some(Display { server, name: format!(":{}", line.trim()) })
}

/// A real window, without a person: opened, resized, given techniques, a broken file and a lost device, looked at, and closed.
#[test]
#[cfg(target_os = "linux")]
fn a_window_lives_through_a_script() {
    let Some(display) = display() else { return };
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("broken.glb"), "not a scene").unwrap();
    let steps = "coarseness 8\nsamples 2\nwait\nexpect picture\nexpect quiet\nsize 700x300\nframes 3\npicture\nwindow A | B | reference\nwait\n\
        technique shadow/map\nwait\nexpect error below 0.5\norbit 30 10\npicture\nlose-device\npicture\nexpect message lost\n\
        drop broken.glb\nwait\nexpect message broken.glb\nsize 480x260\nframes 3\npicture\nscreenshot seen.png";
    std::fs::write(folder.path().join("steps"), steps).unwrap();
    let mut command = kajo(folder.path());
    command.env("DISPLAY", &display.name).env_remove("WAYLAND_DISPLAY").env_remove("WAYLAND_SOCKET");
    let output = command.args(["view", "builtin:shadows", "--size", "640x320", "--script", "steps"]).output().unwrap();
    assert!(output.status.success(), "{}", stderr(&output));
    let seen = kajo_image::read_image(&folder.path().join("seen.png")).unwrap();
    assert_eq!((seen.width(), seen.height()), (480, 260), "the window has the size of the last step");
    // The dark surround alone is darker.
    let mean = seen.pixels().iter().map(|p| p.luminance()).sum::<f32>() / seen.pixels().len() as f32;
    assert!(mean > 0.01, "{mean}");
}
