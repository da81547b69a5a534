//! The words of the command line. Names and flags are a contract: add, do not rename.

pub mod bsdf;
mod values;

pub use values::{ExposureChoice, FrameRange, Size};

use clap::{Args, Parser, Subcommand, ValueEnum};
use glam::Vec3;
use kajo_image::ToneMap;
use kajo_path_tracer::{EnvironmentSampler, Filter, Integrator, LightSampler, Strategy};
use kajo_scene::Culling;
use kajo_viewer::TracedBy;
use std::path::PathBuf;
use std::time::Duration;
use values::{angle_of_view, finite, named, point, positive, seconds, whole};

/// Renders a scene with real-time lighting techniques, shows how wrong each is against a path-traced reference, and what it costs.
#[derive(Debug, Parser)]
#[command(name = "kajo", version, propagate_version = true, arg_required_else_help = true)]
pub struct Kajo {
    /// What every command takes.
    #[command(flatten)]
    pub common: Common,
    /// The command.
    #[command(subcommand)]
    pub command: Command,
}

/// What every command takes.
#[derive(Debug, Args)]
pub struct Common {
    /// Print the result as JSON on stdout
    #[arg(long, global = true)]
    pub json: bool,
    /// No progress, no notes; errors only
    #[arg(long, short, global = true)]
    pub quiet: bool,
}

/// The commands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Render an image of a scene
    Render(Box<Render>),
    /// Look at a scene: techniques beside the path-traced reference, live
    View(ViewCommand),
    /// Compare techniques with the path-traced reference and write a report
    Compare(Box<Compare>),
    /// Show what a scene contains and what of it is ignored
    Info(Info),
    /// List the built-in scenes
    Scenes,
    /// List the techniques, or show one with its parameters
    Techniques {
        /// Technique id, e.g. shadow/map
        id: Option<String>,
        /// The table of the README
        #[arg(long, hide = true)]
        markdown: bool,
    },
    /// Measure how an image differs from a reference
    Metrics(Metrics),
    /// List the requirements and how far each is
    Coverage {
        /// Only rows in this state
        #[arg(long, value_parser = ["done", "partial", "todo"])]
        status: Option<String>,
    },
    /// Reflectance models: list, evaluate, measure
    #[command(subcommand)]
    Bsdf(bsdf::Bsdf),
    /// Time parts of Kajo
    #[command(subcommand)]
    Bench(Bench),
    /// Ask one question about techniques by varying one thing; without a name, list the questions
    Study(StudyCommand),
    /// List the GPU adapters and what they can do
    Devices {
        /// One line an adapter, fields separated by tabs; nothing and exit code 0 without any
        #[arg(long)]
        plain: bool,
    },
}

/// `kajo render`.
#[derive(Debug, Args)]
pub struct Render {
    /// A .gltf, .glb, .obj or .kajo.toml file, or builtin:NAME
    pub scene: String,
    /// Image to write; the ending chooses the format: .png, .exr or .hdr
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    /// Path-traced reference on the CPU, or the real-time renderer on a GPU adapter
    #[arg(long, value_enum, default_value = "reference")]
    pub renderer: RendererChoice,
    /// Image size; 720 rows in the camera's shape if not given
    #[arg(long, value_name = "WxH", allow_hyphen_values = true)]
    pub size: Option<Size>,
    /// Stop after this many samples per pixel [default: 64]; of the real-time renderer the mean of this many frames [default: 1]
    #[arg(long, value_name = "N", group = "stop", allow_negative_numbers = true, value_parser = whole(1..=u32::MAX))]
    pub spp: Option<u32>,
    /// Stop after this time
    #[arg(long, value_name = "SECONDS", group = "stop", allow_negative_numbers = true, value_parser = seconds)]
    pub time: Option<Duration>,
    /// Stop when the relative standard error of the image is below this
    #[arg(long, value_name = "RELERR", group = "stop", allow_negative_numbers = true, value_parser = positive)]
    pub noise: Option<f64>,
    /// After 16 samples a pixel, put more where noise is, --spp being their mean; stays unbiased. --aov samples shows where they went
    #[arg(long)]
    pub adaptive: bool,
    /// Take the noise out of reflected light, for previews: biased, so never judge by it. An .exr keeps the noisy picture as layer `noisy`
    #[arg(long)]
    pub denoise: bool,
    /// Camera, environment, time and animation
    #[command(flatten)]
    pub view: View,
    /// Path tracing settings
    #[command(flatten)]
    pub tracing: Tracing,
    /// Further images in the same EXR, e.g. direct,albedo,visibility.Lamp; `all` for every one. shadow-class.Lamp tells umbra (0), penumbra (1) and lit
    /// (2) at pixel centres; a .png of it alone shows them in colours
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    pub aov: Vec<String>,
    /// What to estimate [default: path]
    #[arg(long, value_parser = named(&Integrator::ALL))]
    pub integrator: Option<Integrator>,
    /// Technique for a role of the real-time renderer, with parameters
    #[arg(long, value_name = "ROLE=ID[:param=value,…]")]
    pub technique: Vec<String>,
    /// Write pictures of the shadow technique's inner workings (silhouettes, volumes, counts, depth of lights, …) into this folder
    #[arg(long, value_name = "DIR")]
    pub debug: Option<PathBuf>,
    /// Frame numbers of a sequence, both inclusive; writes NAME.0001.png and so on
    #[arg(long, value_name = "A..B", allow_hyphen_values = true, conflicts_with_all = ["frame", "checkpoint"])]
    pub frames: Option<FrameRange>,
    /// Frames per second of --frames
    #[arg(long, value_name = "N", default_value = "30", allow_negative_numbers = true, value_parser = positive)]
    pub fps: f64,
    /// Keep the unfinished state here, so that --resume can go on
    #[arg(long, value_name = "FILE")]
    pub checkpoint: Option<PathBuf>,
    /// Go on from the checkpoint
    #[arg(long, requires = "checkpoint")]
    pub resume: bool,
    /// Write time, samples, rays and error as JSON
    #[arg(long, value_name = "FILE.json")]
    pub stats: Option<PathBuf>,
    /// Exposure in stops, or `auto` (middle grey for the average) [default: the scene's own, else auto]; .png only
    #[arg(long, value_name = "STOPS|auto", allow_hyphen_values = true)]
    pub exposure: Option<ExposureChoice>,
    /// Curve from scene to display; .png only
    #[arg(long, value_parser = named(TONE_MAPS), default_value = "pbr-neutral")]
    pub tone_map: ToneMap,
}

/// `kajo view`.
#[derive(Debug, Args)]
pub struct ViewCommand {
    /// A .gltf, .glb, .obj or .kajo.toml file, or builtin:NAME; without one, drop a file on the window
    pub scene: Option<String>,
    /// Latitude-longitude environment (.hdr, .exr, .png) that replaces the scene's
    #[arg(long, value_name = "FILE")]
    pub env: Option<PathBuf>,
    /// Size of the window
    #[arg(long, value_name = "WxH", default_value = "1280x720", allow_hyphen_values = true)]
    pub size: Size,
    /// Samples per pixel of the reference
    #[arg(long, value_name = "N", default_value = "256", allow_negative_numbers = true, value_parser = whole(1..=u32::MAX))]
    pub reference_spp: u32,
    /// Who traces the reference: gpu where it can, else the CPU; auto takes gpu on adapters that are not software
    #[arg(long, value_name = "WHO", value_parser = named(&TracedBy::ALL), default_value = "auto")]
    pub reference: TracedBy,
    /// Carry out the steps of this file instead of a person's, and close; a step that fails ends with exit code 1
    #[arg(long, value_name = "FILE")]
    pub script: Option<PathBuf>,
    /// Close after the first picture and this many frames
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = whole(1..=u32::MAX))]
    pub frames: Option<u32>,
    /// Write the window as it is seen, and close
    #[arg(long, value_name = "OUT.png")]
    pub screenshot: Option<PathBuf>,
    /// Carry out the script without a window
    #[arg(long)]
    pub offscreen: bool,
}

/// What is seen: shared by render and compare.
#[derive(Debug, Args)]
pub struct View {
    /// Camera by name or index
    #[arg(long, value_name = "NAME|INDEX", allow_negative_numbers = true)]
    pub camera: Option<String>,
    /// Put the camera here, m; with --look-at
    #[arg(long, value_name = "X,Y,Z", requires = "look_at", allow_hyphen_values = true, value_parser = point)]
    pub look_from: Option<Vec3>,
    /// Point in the middle of the picture, m; with --look-from
    #[arg(long, value_name = "X,Y,Z", requires = "look_from", allow_hyphen_values = true, value_parser = point)]
    pub look_at: Option<Vec3>,
    /// Vertical angle of view of the camera that --look-from places
    #[arg(long, value_name = "DEG", requires = "look_from", allow_negative_numbers = true, value_parser = angle_of_view)]
    pub fov: Option<f64>,
    /// Latitude-longitude environment (.hdr, .exr, .png) that replaces the scene's
    #[arg(long, value_name = "FILE")]
    pub env: Option<PathBuf>,
    /// Time of the animation, s
    #[arg(long, value_name = "T", default_value = "0", allow_negative_numbers = true, value_parser = finite)]
    pub frame: f64,
    /// Animation by name or index [default: the first]
    #[arg(long, value_name = "NAME|INDEX", allow_negative_numbers = true)]
    pub animation: Option<String>,
    /// Ambient visibility: how far surfaces block [default: render: without end; compare: a tenth of the scene's diagonal]
    #[arg(long, value_name = "METRES", allow_negative_numbers = true, value_parser = positive)]
    pub ambient_distance: Option<f64>,
    /// Leave instances out of what rays meet that start on surfaces: by distance from the camera, outside a frustum widened by so much, by radius, or by the
    /// solid angle seen from the camera; lights stay. In compare the reference has all [off, distance:M, frustum:M, size:M, solid-angle:SR]
    #[arg(long, value_name = "WAY:THRESHOLD", default_value = "off")]
    pub ray_culling: Culling,
}

/// How light paths are sampled.
#[derive(Debug, Args)]
pub struct Tracing {
    /// Longest path, in surface bounces; 1 is direct light [default: 32]
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = whole(0..=10_000u32))]
    pub max_depth: Option<u32>,
    /// No Russian roulette
    #[arg(long)]
    pub no_rr: bool,
    /// Seed of all random numbers
    #[arg(long, value_name = "N", default_value = "0", allow_negative_numbers = true, value_parser = whole(0..=u64::MAX))]
    pub seed: u64,
    /// Worker threads [default: all]; does not change the result
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = whole(1..=1024u16))]
    pub threads: Option<u16>,
    /// Random numbers [default: sobol]
    #[arg(long, value_parser = named(SAMPLERS))]
    pub sampler: Option<SamplerChoice>,
    /// How direct light is found: mis, or lights, by shadow rays alone [default: mis]; changes the noise, not the mean
    #[arg(long, value_parser = named(&Strategy::ALL))]
    pub strategy: Option<Strategy>,
    /// How directions towards an environment are drawn [default: cdf]; changes the noise, not the mean
    #[arg(long, value_parser = named(&EnvironmentSampler::ALL))]
    pub env_sampler: Option<EnvironmentSampler>,
    /// How one of many lights is chosen [default: bvh]; changes the noise, not the mean
    #[arg(long, value_parser = named(&LightSampler::ALL))]
    pub light_sampler: Option<LightSampler>,
    /// Reconstruction filter [default: blackman-harris]
    #[arg(long, value_parser = named(&Filter::ALL))]
    pub filter: Option<Filter>,
}

/// `kajo compare`.
#[derive(Debug, Args)]
pub struct Compare {
    /// Scenes: .gltf, .glb, .obj or .kajo.toml files, or builtin:NAME
    #[arg(required = true, num_args = 1..)]
    pub scenes: Vec<String>,
    /// Folder of the report: index.html, report.json, table.csv and images
    #[arg(short, long, value_name = "DIR")]
    pub output: PathBuf,
    /// Roles to compare, separated by commas [default: every role that has techniques]
    #[arg(long, value_name = "ROLE", value_delimiter = ',')]
    pub role: Vec<String>,
    /// Techniques to compare, with parameters, separated by commas; may be given several times
    #[arg(long, value_name = "ID[:param=value,…],…")]
    pub technique: Vec<String>,
    /// Every technique of the roles (what happens without --technique, too)
    #[arg(long, conflicts_with = "technique")]
    pub all: bool,
    /// Image size; 720 rows in the camera's shape if not given
    #[arg(long, value_name = "WxH", allow_hyphen_values = true)]
    pub size: Option<Size>,
    /// Samples per pixel of the reference [default: 256]
    #[arg(long, value_name = "N", group = "reference", allow_negative_numbers = true, value_parser = whole(1..=u32::MAX))]
    pub reference_spp: Option<u32>,
    /// Relative standard error at which the reference stops
    #[arg(long, value_name = "E", group = "reference", allow_negative_numbers = true, value_parser = positive)]
    pub reference_noise: Option<f64>,
    /// Timed frames of each technique
    #[arg(long, value_name = "N", default_value = "10", allow_negative_numbers = true, value_parser = whole(1..=u32::MAX))]
    pub frames: u32,
    /// Repeats with other seeds, which split the error into bias and noise
    #[arg(long, value_name = "N", default_value = "4", allow_negative_numbers = true, value_parser = whole(1..=u32::MAX))]
    pub repeat: u32,
    /// Frames of each moving sequence (camera, light and a thing move, or the scene's animation plays): flicker, lag and ghosts. Each frame needs a reference of its
    /// own, so none are rendered unless asked for; ghosts need 3, and 8 is enough for most scenes
    #[arg(long, value_name = "N", default_value = "0", allow_negative_numbers = true, value_parser = whole(0..=1000u32))]
    pub temporal: u32,
    /// Recommend the lowest error below this cost
    #[arg(long, value_name = "X", allow_negative_numbers = true, value_parser = positive)]
    pub budget_ms: Option<f64>,
    /// Camera, environment, time and animation
    #[command(flatten)]
    pub view: View,
    /// Seed of all random numbers
    #[arg(long, value_name = "N", default_value = "0", allow_negative_numbers = true, value_parser = whole(0..=u64::MAX))]
    pub seed: u64,
    /// Worker threads of the reference [default: all]
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = whole(1..=1024u16))]
    pub threads: Option<u16>,
}

/// `kajo study`.
#[derive(Debug, Args)]
pub struct StudyCommand {
    /// The study, e.g. shadow-bias
    #[arg(requires = "output")]
    pub name: Option<String>,
    /// Folder of the report: index.html, report.json, tables, plots and pictures
    #[arg(short, long, value_name = "DIR", requires = "name")]
    pub output: Option<PathBuf>,
    /// Fewer steps and smaller pictures
    #[arg(long)]
    pub quick: bool,
}

/// `kajo info`.
#[derive(Debug, Args)]
pub struct Info {
    /// A .gltf, .glb, .obj or .kajo.toml file, or builtin:NAME
    pub scene: String,
}

/// `kajo bench`.
#[derive(Debug, Subcommand)]
pub enum Bench {
    /// Path trace pictures: samples and rays a second, error, efficiency 1 / (time x MSE), and how cost grows
    Render(Box<BenchRender>),
    /// Build a hierarchy over triangles and trace rays through it, on the CPU
    Rays(BenchRays),
    /// Sample an environment by blocks, by inversion and by alias tables: time, memory, fit, and what the blocks keep of the image
    Environment(BenchEnvironment),
}

/// `kajo bench render`.
#[derive(Debug, Args)]
pub struct BenchRender {
    /// Scenes: .gltf, .glb, .obj or .kajo.toml files, or builtin:NAME [default: a set of built-in ones]
    pub scenes: Vec<String>,
    /// How cost grows with this; `triangles` and `lights` make their own scenes
    #[arg(long, value_enum)]
    pub study: Option<Study>,
    /// How far a study goes: `full` takes much time and memory
    #[arg(long, value_enum, default_value = "reduced")]
    pub profile: Profile,
    /// Image size [default: that of the reference, else 256x256]
    #[arg(long, value_name = "WxH", allow_hyphen_values = true)]
    pub size: Option<Size>,
    /// Samples per pixel
    #[arg(long, value_name = "N", default_value = "16", allow_negative_numbers = true, value_parser = whole(1..=u32::MAX))]
    pub spp: u32,
    /// Pictures with different seeds; the fastest counts, and their scatter is the error
    #[arg(long, value_name = "N", default_value = "4", allow_negative_numbers = true, value_parser = whole(1..=1000u32))]
    pub repeat: u32,
    /// Measure the error against this picture (.exr, .hdr) instead, e.g. by `kajo render` with the same settings, another --seed and thousands of samples
    #[arg(long, value_name = "FILE")]
    pub reference: Option<PathBuf>,
    /// Camera, environment, time and animation
    #[command(flatten)]
    pub view: View,
    /// Path tracing settings
    #[command(flatten)]
    pub tracing: Tracing,
}

/// What a study varies.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Study {
    /// `builtin:terrain:N`, N = 1000 to 10 million.
    Triangles,
    /// `builtin:many-lights:N`, N = 1 to 100 000.
    Lights,
    /// From one to all of this machine.
    Threads,
    /// Squares of 64 to 2048 px.
    Resolution,
}

impl Study {
    /// As it is written on the command line.
    pub fn name(self) -> String {
        self.to_possible_value().map_or_else(String::new, |value| value.get_name().to_owned())
    }
}

/// How far a study goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
#[allow(missing_docs, reason = "the words say it")]
pub enum Profile {
    Reduced,
    Full,
}

/// `kajo bench environment`.
#[derive(Debug, Args)]
pub struct BenchEnvironment {
    /// Latitude-longitude environment (.hdr, .exr, .png)
    #[arg(long, value_name = "FILE")]
    pub env: PathBuf,
    /// Blocks of the kd-tree [default: one for 170 pixels]
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = whole(1..=u32::MAX))]
    pub blocks: Option<u32>,
    /// Write the environment as its blocks have it (.exr, .hdr)
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
}

/// `kajo bench rays`.
#[derive(Debug, Args)]
pub struct BenchRays {
    /// Triangles: little-endian f32, nine each
    #[arg(long, value_name = "FILE")]
    pub triangles: PathBuf,
    /// Rays: little-endian f32, eight each: origin, direction, tmin, tmax
    #[arg(long, value_name = "FILE")]
    pub rays: PathBuf,
    /// Ask whether anything is hit instead of what is hit first
    #[arg(long)]
    pub any_hit: bool,
    /// Trace each ray by itself instead of neighbours together where they run alike
    #[arg(long)]
    pub one_at_a_time: bool,
    /// What the build spends its time on; does not change the hits
    #[arg(long, value_enum, default_value = "balanced")]
    pub build_quality: Quality,
    /// Worker threads [default: all]; does not change the result
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = whole(1..=1024u16))]
    pub threads: Option<u16>,
    /// Builds and traces this often; the best counts
    #[arg(long, value_name = "N", default_value = "5", allow_negative_numbers = true, value_parser = whole(1..=u32::MAX))]
    pub repeat: u32,
}

/// The builds of `kajo_bvh`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Quality {
    /// The least time.
    Fast,
    /// The best of many planes at every node.
    Balanced,
    /// Also planes that cut triangles in two.
    High,
}

/// `kajo metrics`.
#[derive(Debug, Args)]
pub struct Metrics {
    /// The image to judge (.exr, .hdr, .png, .jpg)
    pub image: PathBuf,
    /// What it should be
    pub reference: PathBuf,
    /// Write the FLIP error map here (.png)
    #[arg(long, value_name = "FILE.png")]
    pub heatmap: Option<PathBuf>,
}

/// The two renderers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
#[allow(missing_docs, reason = "the words say it")]
pub enum RendererChoice {
    Reference,
    Realtime,
}

/// Random number sequences, by the name users write.
const SAMPLERS: &[(&str, SamplerChoice)] =
    &[("sobol", SamplerChoice::Sobol), ("blue-noise", SamplerChoice::BlueNoise), ("independent", SamplerChoice::Independent)];

/// Tone maps, by the name users write.
const TONE_MAPS: &[(&str, ToneMap)] =
    &[("pbr-neutral", ToneMap::PbrNeutral), ("agx", ToneMap::Agx), ("aces", ToneMap::Aces), ("linear", ToneMap::Linear)];

/// Random number sequences.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SamplerChoice {
    /// Owen-scrambled Sobol points.
    Sobol,
    /// Sobol points dealt to the pixels so that the error of the image is blue noise.
    BlueNoise,
    /// Independent uniform numbers.
    Independent,
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_command_line_is_consistent() {
        Kajo::command().debug_assert();
    }
}
