//! `setup`: a Vulkan adapter for the real-time side, installed from the system's own packages where none answers.

use crate::shell;
use std::fs;
use std::path::Path;

/// Where a Debian 12 system learns of the suite that has a Mesa with ray queries.
const BACKPORTS: &str = "/etc/apt/sources.list.d/kajo-bookworm-backports.sources";

/// Finds an adapter, or installs Mesa's software driver and finds that.
pub fn run() -> Result<(), String> {
    shell::run("cargo", &["build", "--release", "--package", "kajo-cli"])?;
    let before = adapters();
    if before.is_good() {
        println!("setup: {}", before.describe());
        return Ok(());
    }
    println!("setup: {}", before.describe());
    if !cfg!(target_os = "linux") {
        return Err("no adapter answers; update the graphics driver (Metal and Direct3D 12 come with the system)".into());
    }
    if !shell::succeeds("apt-get", &["--version"]) {
        return Err(format!("no usable adapter, and this is no apt system; type: {}", line_for_other_systems()));
    }
    install_mesa()?;
    let after = adapters();
    println!("setup: {}", after.describe());
    if after.any { Ok(()) } else { Err("the driver is installed but no adapter answers; `kajo devices` says what was tried".into()) }
}

/// What `kajo devices` found.
struct Adapters {
    any: bool,
    software_without_ray_query: bool,
    text: String,
}

impl Adapters {
    fn is_good(&self) -> bool {
        self.any && !self.software_without_ray_query
    }

    fn describe(&self) -> String {
        match (self.any, self.software_without_ray_query) {
            (false, _) => "no GPU adapter answers".into(),
            (true, true) => format!("the software driver is too old for ray queries ({})", self.text),
            (true, false) => format!("adapter: {}", self.text),
        }
    }
}

/// Asks the built `kajo`, which prints one line an adapter, the best first: name, type and features, separated by tabs.
fn adapters() -> Adapters {
    let kajo = shell::workspace_root().join("target/release/kajo").display().to_string();
    let text = shell::output(&kajo, &["devices", "--plain"]).unwrap_or_default();
    let best = text.lines().next().unwrap_or_default().to_string();
    Adapters {
        any: !best.is_empty(),
        software_without_ray_query: best.contains("\tsoftware\t") && !best.contains("ray-query"),
        text: best.replace('\t', ", "),
    }
}

fn install_mesa() -> Result<(), String> {
    let release = fs::read_to_string("/etc/os-release").unwrap_or_default();
    let is_bookworm = release.lines().any(|line| line == "VERSION_CODENAME=bookworm") && release.lines().any(|line| line == "ID=debian");
    if is_bookworm && !Path::new(BACKPORTS).exists() {
        println!("setup: adding the suite bookworm-backports, whose Mesa has ray queries ({BACKPORTS})");
        write_as_root(BACKPORTS, &backports_source()?)?;
    }
    as_root(&["apt-get", "update"])?;
    let suite: &[&str] = if is_bookworm { &["-t", "bookworm-backports"] } else { &[] };
    println!("setup: installing Mesa's software Vulkan driver");
    let install = ["env", "DEBIAN_FRONTEND=noninteractive", "apt-get", "install", "-y", "--no-install-recommends"];
    as_root(&[&install[..], suite, &["mesa-vulkan-drivers", "libvulkan1"]].concat())
}

/// An X server without a screen, and what windows of X11 load when they open.
const DISPLAY: [&str; 7] = ["xvfb", "libx11-6", "libx11-xcb1", "libxcursor1", "libxi6", "libxkbcommon0", "libxkbcommon-x11-0"];

/// Installs a display that nobody sees, for the test of the viewer's window; without the right to, that test is left out and says so.
pub fn display() {
    let root = || shell::output("id", &["-u"]).is_some_and(|id| id.trim() == "0");
    if !cfg!(target_os = "linux") || shell::succeeds("Xvfb", &["-version"]) || !shell::succeeds("apt-get", &["--version"]) {
        return;
    }
    if !root() {
        println!("setup: the test of the viewer's window needs a display; as root: apt-get install {}", DISPLAY.join(" "));
        return;
    }
    println!("setup: installing Xvfb for the test of the viewer's window");
    let install = ["env", "DEBIAN_FRONTEND=noninteractive", "apt-get", "install", "-y", "--no-install-recommends"];
    let installed = as_root(&["apt-get", "update"]).and_then(|()| as_root(&[&install[..], &DISPLAY].concat()));
    if let Err(reason) = installed {
        println!("setup: {reason}; the test of the viewer's window is left out");
    }
}

/// The machine's own Debian source with the suite replaced.
fn backports_source() -> Result<String, String> {
    let path = "/etc/apt/sources.list.d/debian.sources";
    let own = fs::read_to_string(path).or_else(|_| fs::read_to_string("/etc/apt/sources.list")).map_err(|e| format!("{path}: {e}"))?;
    source_with_suite(&own, "bookworm-backports").ok_or(format!("{path}: no Debian source found to take the address from"))
}

/// Takes address and key of the first source in `own`, in either of apt's two formats.
fn source_with_suite(own: &str, suite: &str) -> Option<String> {
    let field = |name: &str| own.lines().find_map(|line| line.strip_prefix(name)).map(str::trim);
    if let Some(uri) = field("URIs:") {
        let key = field("Signed-By:").map(|key| format!("Signed-By: {key}\n")).unwrap_or_default();
        return Some(format!("Types: deb\nURIs: {uri}\nSuites: {suite}\nComponents: main\n{key}"));
    }
    let line = own.lines().map(str::trim).find(|line| line.starts_with("deb "))?;
    let uri = line.split_whitespace().find(|word| word.contains("://"))?;
    Some(format!("Types: deb\nURIs: {uri}\nSuites: {suite}\nComponents: main\nSigned-By: /usr/share/keyrings/debian-archive-keyring.gpg\n"))
}

fn write_as_root(path: &str, text: &str) -> Result<(), String> {
    if fs::write(path, text).is_ok() {
        return Ok(());
    }
    let temporary = std::env::temp_dir().join("kajo-apt-source");
    fs::write(&temporary, text).map_err(|e| format!("{}: {e}", temporary.display()))?;
    as_root(&["install", "-m", "644", &temporary.display().to_string(), path])
}

fn as_root(command: &[&str]) -> Result<(), String> {
    if shell::output("id", &["-u"]).is_some_and(|id| id.trim() == "0") {
        return shell::run(command[0], &command[1..]);
    }
    if shell::succeeds("sudo", &["--version"]) {
        return shell::run("sudo", command);
    }
    Err(format!("installing needs root; type this as root, then run the command again: {}", command.join(" ")))
}

fn line_for_other_systems() -> &'static str {
    match () {
        () if shell::succeeds("dnf", &["--version"]) => "sudo dnf install mesa-vulkan-drivers vulkan-loader",
        () if shell::succeeds("pacman", &["--version"]) => "sudo pacman -S vulkan-swrast vulkan-icd-loader",
        () if shell::succeeds("zypper", &["--version"]) => "sudo zypper install libvulkan_lvp libvulkan1",
        () if shell::succeeds("apk", &["--version"]) => "sudo apk add mesa-vulkan-swrast vulkan-loader",
        () => "install your system's Mesa Vulkan driver (lavapipe) 24.3 or newer and the Vulkan loader",
    }
}

#[cfg(test)]
mod tests {
    use super::source_with_suite;

    #[test]
    fn suite_is_replaced_in_the_new_format() {
        let own = "Types: deb\nURIs: https://example.org/debian\nSuites: bookworm\nComponents: main\nSigned-By: /k.gpg\n";
        let expected = "Types: deb\nURIs: https://example.org/debian\nSuites: x\nComponents: main\nSigned-By: /k.gpg\n";
        assert_eq!(source_with_suite(own, "x").as_deref(), Some(expected));
    }

    #[test]
    fn suite_is_replaced_in_the_one_line_format() {
        for own in
            ["deb https://example.org/debian bookworm main\n", "# c\ndeb [ signed-by=/k.gpg ] https://example.org/debian bookworm main\n"]
        {
            let source = source_with_suite(own, "x").expect("a source");
            assert!(source.contains("URIs: https://example.org/debian\nSuites: x\n"), "{source}");
        }
    }

    #[test]
    fn a_file_without_a_source_gives_nothing() {
        assert_eq!(source_with_suite("# empty\n", "x"), None);
    }
}
