//! The whole viewer without a window, by scripts as a person would use it.

use crate::app::App;
use crate::headless;
use crate::script::{Runner, parse};
use glam::UVec2;
use std::path::Path;

/// Wide enough for the panels, and a picture of a few thousand pixels.
const SIZE: UVec2 = UVec2::new(420, 120);

fn run_with(app: &mut App, text: &str) -> Result<(), String> {
    app.model.spp = 2;
    let mut script = Runner::new("test", parse("test", text).unwrap());
    headless::run(app, &mut script, SIZE).map_err(|error| error.to_string())
}

fn run(text: &str) -> Result<(), String> {
    run_with(&mut App::new(), text)
}

fn read(path: &Path) -> kajo_image::Image<kajo_units::LinearRgb> {
    kajo_image::read_image(path).unwrap()
}

#[test]
fn a_scene_is_seen_judged_and_kept() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let script = format!(
        "open builtin:cornell\nwait\nexpect picture\nexpect quiet\nexpect error below 0.2\nscreenshot {}\nsave {}\nsave {}",
        path("window.png").display(),
        path("picture.png").display(),
        path("picture.exr").display()
    );
    run(&script).unwrap();
    assert_eq!(read(&path("window.png")).size(), SIZE);
    let picture = read(&path("picture.png"));
    let mean = picture.pixels().iter().map(|p| p.luminance()).sum::<f32>() / picture.pixels().len() as f32;
    assert!(mean > 0.02 && mean < 0.8, "{mean}");
    let file = kajo_image::ExrFile::read(&path("picture.exr")).unwrap();
    assert!(file.layer("direct").is_some() && file.layer("reference").is_some());
    assert!(file.metadata["command"].starts_with("kajo render builtin:cornell"), "{:?}", file.metadata);
}

#[test]
fn every_window_picture_and_technique_can_be_shown() {
    let mut script = "open builtin:penumbra\ncoarseness 4\nwait\n".to_owned();
    for preset in crate::layout::PRESETS {
        script += &format!("window {}\nwait\nexpect quiet\n", preset.name);
    }
    for show in
        ["direct", "role", "light 0", "classes 0", "failures", "channel depth", "channel shading normal", "channel instances", "picture"]
    {
        script += &format!("show {show}\npicture\nexpect quiet\n");
    }
    for technique in kajo_techniques::all() {
        script += &format!("technique {}\npicture\nexpect quiet\n", technique.id);
    }
    run(&script).unwrap();
}

/// Exposure that follows comes to rest where the mean is middle grey, in the light of all lamps and in the dark of one less.
#[test]
fn exposure_follows_what_is_seen() {
    let exposure = |text: &str| {
        let mut app = App::new();
        run_with(&mut app, &format!("open builtin:shadows\nwait\n{text}\nwait\nexpect quiet")).unwrap();
        let frames = app.model.frames.as_ref().unwrap();
        (app.model.exposure, kajo_image::auto_exposure(&frames.sides[0].as_ref().unwrap().color))
    };
    let (bright, metered) = exposure("exposure auto");
    assert!((bright - metered).abs() < 0.06, "{bright} {metered}");
    let (dark, metered) = exposure("exposure auto\nwait\nlight 0 off");
    assert!((dark - metered).abs() < 0.06, "{dark} {metered}");
    assert!(dark > bright + 0.2, "{dark} {bright}");
    assert_eq!(exposure("exposure auto\nwait\nexposure -1").0, -1.0);
}

/// The classes of a light and the faults of a hard shadow are pictures in their own colours: the penumbra is there, and missed.
#[test]
fn classes_and_failures_are_seen_in_their_colours() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let script = format!(
        "open builtin:penumbra\nsize 1200x700\npicture\ncoarseness 1\nsamples 32\ntechnique shadow/map:kernel=0\nshow classes 0\nwait\nshow failures\nwait\nexpect quiet\nsave {}\ntechnique \
         shadow/ray-traced\nshow classes 0\nwait\nexpect quiet\nsave {}",
        path("failures.png").display(),
        path("classes.png").display()
    );
    run(&script).unwrap();
    let count = |name: &str, color: kajo_units::Srgb8| read(&path(name)).pixels().iter().filter(|p| p.to_srgb8() == color).count();
    let missed = count("failures.png", kajo_lab::failures::Class::MissedPenumbra.color());
    assert!(missed > 10, "{missed} pixels miss the penumbra");
    for class in kajo_image_metrics::ShadowClass::ALL {
        assert!(count("classes.png", class.color()) > 100, "{}", class.name());
    }
}

#[test]
fn broken_files_and_foreign_ones_are_told_and_the_scene_stays() {
    let folder = tempfile::tempdir().unwrap();
    let broken = folder.path().join("broken.glb");
    std::fs::write(&broken, b"glTF but no more").unwrap();
    let script = format!(
        "open builtin:cornell\npicture\nexpect quiet\ndrop {}\nwait\nexpect message broken.glb\nexpect picture\ndrop notes.txt\nexpect message notes.txt cannot be shown\nexpect picture",
        broken.display()
    );
    run(&script).unwrap();
}

#[test]
fn a_window_without_room_for_a_picture_is_told_from_one_without_a_scene() {
    let error = run("open builtin:cornell\nwait\nsize 0x0\nframes 2\npicture").unwrap_err();
    assert!(error.contains("no room"), "{error}");
    let error = run("picture").unwrap_err();
    assert!(error.contains("no scene"), "{error}");
}

#[test]
fn nothing_to_see_is_said_and_an_environment_alone_is_refused() {
    run("frames 2\ndrop sky.hdr\nexpect message drop the scene first\nopen /no/such/scene.gltf\nframes 2\nwait\nexpect message /no/such/scene.gltf").unwrap();
}

#[test]
fn a_lost_device_is_opened_again() {
    run("open builtin:cornell\npicture\nlose-device\npicture\nexpect message lost\nexpect picture\norbit 10 0\npicture\nexpect picture")
        .unwrap();
}

#[test]
fn sizes_change_down_to_nothing_and_back() {
    run(
        "open builtin:cornell\npicture\nsize 500x300\npicture\nsize 0x0\nframes 2\nsize 1x1\nframes 2\nsize 420x120\npicture\nexpect quiet",
    )
    .unwrap();
}

#[test]
fn lights_time_and_cameras_change_both_renderers() {
    run("open builtin:moving\nwait\nlight 0 off\nwait\nexpect quiet\nlight 0 on\nlook 1,2,6 0,1,0\nwait\nexpect error below 0.3\nexpect quiet").unwrap();
}

/// The device's path tracer judges as the CPU's does: the same RMSE, of the picture and of irradiance, but for noise; what it cannot judge goes to the CPU by itself.
#[test]
fn the_reference_is_traced_by_the_device_where_that_is_asked_for() {
    for (role, technique) in [("anti-alias", "aa/none"), ("diffuse-indirect", "gi/none")] {
        let errors = |by: &str| {
            let mut app = App::new();
            let start = format!(
                "open builtin:cornell\njudge {role}\ntechnique {technique}\ncoarseness 2\nsamples 64\nreference {by}\nwindow A | reference"
            );
            run_with(&mut app, &format!("{start}\nwait\nexpect quiet\nexpect picture\nexpect reference {by}\nexpect error below 5"))
                .unwrap();
            match &app.model.errors[0] {
                Some(Ok(errors)) => (errors.rmse, errors.floor.unwrap(), errors.flip),
                other => panic!("{other:?}"),
            }
        };
        let ((cpu, floor, cpu_flip), (device, other, device_flip)) = (errors("cpu"), errors("gpu"));
        let expected = |rmse: f64, floor: f64| (rmse * rmse - floor * floor).max(0.0).sqrt();
        let (a, b) = (expected(cpu, floor), expected(device, other));
        assert!((a - b).abs() < 0.1 * a + 0.2 * floor.max(other), "{role}: {cpu} ({floor}) and {device} ({other})");
        // Light that one of them lacks hides behind bright edges in the RMSE, and not here.
        assert!((cpu_flip - device_flip).abs() < 0.05, "{role}: {cpu_flip} and {device_flip}");
    }
    let visibility = "open builtin:cornell\ncoarseness 2\nreference gpu\nwait\nexpect quiet\nexpect reference ";
    run(&format!("{visibility}cpu")).unwrap();
    let error = run(&format!("{visibility}gpu")).unwrap_err();
    assert!(error.contains("the CPU has traced the reference: the images of visibilities"), "{error}");
}

#[test]
fn expectations_that_are_not_met_end_the_script_with_its_line() {
    for (line, reason) in [
        ("expect picture", "no picture"),
        ("expect message x", "no message"),
        ("expect error below 1", "not known"),
        ("expect steady", "no `mark`"),
    ] {
        let error = run(&format!("frames 1\n{line}")).unwrap_err();
        assert!(error.starts_with("test: line 2: ") && error.contains(reason), "{error}");
    }
}

#[test]
fn a_scene_of_nothing_but_sky_is_a_picture_and_says_that_nothing_is_judged() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("sky.kajo.toml");
    std::fs::write(&path, "[environment]\nradiance = 1").unwrap();
    run(&format!("open {}\nwait\nexpect picture\nexpect message nothing to judge", path.display())).unwrap();
}

/// `KAJO_VIEW_FRAMES` asks for more of them.
#[test]
fn many_frames_leave_memory_and_resources_as_they_were() {
    let frames: u32 = std::env::var("KAJO_VIEW_FRAMES").ok().and_then(|text| text.parse().ok()).unwrap_or(150);
    let mut app = App::new();
    app.model.judging = false;
    let start = "open builtin:cornell\ncoarseness 2\nwindow A | B\npicture\nspin 30\nmark\n";
    run_with(&mut app, &format!("{start}spin {frames}\npicture\nexpect steady\nexpect quiet")).unwrap();
}
