//! The words of `kajo bsdf`.

use clap::{Args, Subcommand, ValueEnum};
use kajo_bsdf::models;
use std::path::PathBuf;

/// Reflectance models: list, evaluate, measure.
#[derive(Debug, Subcommand)]
pub enum Bsdf {
    /// List the models with their parameters, ranges and units, or show one
    List {
        /// Model id, e.g. ward
        id: Option<String>,
        /// The table of the README
        #[arg(long, hide = true)]
        markdown: bool,
    },
    /// Evaluate a model for one pair of directions
    Eval(Eval),
    /// Directional albedo, by quadrature and by the model's own samples
    Albedo(Albedo),
    /// Check reciprocity, energy and finite numbers, of one model or of all
    Check(Check),
    /// What the literature claims of the models beside what is measured
    Table(Table),
    /// Draw: the survey's curves, the lobes of a model, or a gallery of every picture with a page that shows it
    Plot(Plot),
    /// Check that samples follow their density, and that value and density give the albedo
    SampleTest(SampleTest),
    /// What a call costs: one by one and many at once, in nanoseconds and in operations, beside the survey's measurements
    Bench(Bench),
    /// Fit a model's numbers to another model or to a table of values
    Fit(Box<Fit>),
    /// Factor a model, of a formula or measured, into functions of one angle, for models nmf and tucker
    Factor(Factor),
}

/// One model with parameters, or all models with their defaults.
#[derive(Debug, Args)]
pub struct Models {
    /// Model id [default: every model]
    #[arg(long, value_name = "ID")]
    pub model: Option<String>,
    /// A parameter of the model. Repeatable
    #[arg(long = "param", value_name = "NAME=VALUE", num_args = 1.., value_parser = pair, requires = "model")]
    pub params: Vec<(String, String)>,
    /// The form that keeps what the model claims, or as printed in its source
    #[arg(long, value_enum, default_value = "corrected")]
    pub form: Form,
}

/// `kajo bsdf table`.
#[derive(Debug, Args)]
pub struct Table {
    /// The form that keeps what the model claims, or as printed in its source
    #[arg(long, value_enum, default_value = "corrected")]
    pub form: Form,
    /// The misprints instead, each with its value as printed and as implemented
    #[arg(long, conflicts_with_all = ["claims", "form"])]
    pub errata: bool,
    /// Single claims instead, each with the numbers that decide it
    #[arg(long, conflicts_with = "form")]
    pub claims: bool,
}

/// `kajo bsdf plot`.
#[derive(Debug, Args)]
#[command(group(clap::ArgGroup::new("what").args(["figure", "curves", "gallery"]).required(true).multiple(true)))]
pub struct Plot {
    /// Figures of the survey, separated by commas
    #[arg(long, value_name = "N", value_delimiter = ',', value_parser = kajo_bsdf_lab::figures::SURVEY_FIGURES)]
    pub figure: Vec<String>,
    /// Model whose lobe in the plane of incidence is drawn, over angles and as arrows
    #[arg(long, value_name = "ID")]
    pub curves: Option<String>,
    /// A parameter of the model. Repeatable
    #[arg(long = "param", value_name = "NAME=VALUE", num_args = 1.., value_parser = pair, requires = "curves")]
    pub params: Vec<(String, String)>,
    /// The form that keeps what the model claims, or as printed in its source
    #[arg(long, value_enum, default_value = "corrected")]
    pub form: Form,
    /// Inclinations of the light from the normal, a lobe for each
    #[arg(long, value_name = "DEG", value_delimiter = ',', default_value = "0,30,60", value_parser = above)]
    pub theta_i: Vec<f64>,
    /// Every picture of the models with what is measured on it, path traced, and a page: takes minutes
    #[arg(long, conflicts_with_all = ["figure", "curves"])]
    pub gallery: bool,
    /// Width of the gallery's pictures in pixels [default: 1000]
    #[arg(long, value_name = "PX", conflicts_with_all = ["figure", "curves"], value_parser = clap::value_parser!(u32).range(100..=8000))]
    pub width: Option<u32>,
    /// Samples per pixel of the gallery's pictures [default: 32]
    #[arg(long, value_name = "N", conflicts_with_all = ["figure", "curves"], value_parser = clap::value_parser!(u32).range(1..=65_536))]
    pub spp: Option<u32>,
    /// Folder of the files
    #[arg(short, long, value_name = "DIR")]
    pub output: PathBuf,
}

/// `kajo bsdf check`.
#[derive(Debug, Args)]
pub struct Check {
    /// What to check.
    #[command(flatten)]
    pub models: Models,
    /// Random pairs of directions
    #[arg(long, value_name = "N", default_value = "20000", value_parser = clap::value_parser!(u32).range(1..=100_000_000))]
    pub pairs: u32,
    /// Random numbers start here
    #[arg(long, value_name = "N", default_value = "0")]
    pub seed: u64,
}

/// `kajo bsdf sample-test`.
#[derive(Debug, Args)]
pub struct SampleTest {
    /// What to check.
    #[command(flatten)]
    pub models: Models,
    /// Inclinations of the viewer from the normal
    #[arg(long, value_name = "DEG", value_delimiter = ',', default_value = "0,45,70,85", value_parser = inclination)]
    pub theta_r: Vec<f64>,
    /// Azimuth of the viewer from the tangent x
    #[arg(long, value_name = "DEG", default_value = "0", allow_negative_numbers = true, value_parser = angle)]
    pub phi_r: f64,
    /// Samples for each inclination
    #[arg(long, value_name = "N", default_value = "200000", value_parser = clap::value_parser!(u32).range(1000..=1_000_000_000))]
    pub samples: u32,
    /// Random numbers start here
    #[arg(long, value_name = "N", default_value = "0")]
    pub seed: u64,
}

/// `kajo bsdf bench`.
#[derive(Debug, Args)]
pub struct Bench {
    /// Model ids, separated by commas [default: every model]
    #[arg(long, value_name = "ID", value_delimiter = ',')]
    pub model: Vec<String>,
    /// Every model that needs no file
    #[arg(long, conflicts_with = "model")]
    pub all: bool,
    /// A parameter of the model, where one is chosen. Repeatable
    #[arg(long = "param", value_name = "NAME=VALUE", num_args = 1.., value_parser = pair, requires = "model")]
    pub params: Vec<(String, String)>,
    /// Calls of each kind for each model, rounded up to whole sets of inputs
    #[arg(long, value_name = "N", default_value = "100000000", value_parser = clap::value_parser!(u64).range(1..=1_000_000_000_000))]
    pub calls: u64,
    /// Also on the graphics processor, where one answers
    #[arg(long)]
    pub gpu: bool,
}

/// A model with parameters.
#[derive(Clone, Debug, Args)]
pub struct ModelChoice {
    /// Model id: see `kajo bsdf list`
    #[arg(long, value_name = "ID")]
    pub model: String,
    /// A parameter; a colour is one number or r,g,b. Repeatable
    #[arg(long = "param", value_name = "NAME=VALUE", num_args = 1.., value_parser = pair)]
    pub params: Vec<(String, String)>,
    /// The form that keeps what the model claims, or as printed in its source
    #[arg(long, value_enum, default_value = "corrected")]
    pub form: Form,
}

/// Which form of an equation.
#[derive(Clone, Copy, Debug, ValueEnum)]
#[allow(missing_docs, reason = "the names say it")]
pub enum Form {
    Corrected,
    Printed,
}

impl From<Form> for models::Form {
    fn from(form: Form) -> Self {
        match form {
            Form::Corrected => Self::Corrected,
            Form::Printed => Self::Printed,
        }
    }
}

/// `kajo bsdf eval`.
#[derive(Debug, Args)]
pub struct Eval {
    /// The model.
    #[command(flatten)]
    pub model: ModelChoice,
    /// Inclination of the light from the normal
    #[arg(long, value_name = "DEG", allow_negative_numbers = true, value_parser = inclination)]
    pub theta_i: f64,
    /// Azimuth of the light from the tangent x
    #[arg(long, value_name = "DEG", default_value = "0", allow_negative_numbers = true, value_parser = angle)]
    pub phi_i: f64,
    /// Inclination of the viewer from the normal
    #[arg(long, value_name = "DEG", allow_negative_numbers = true, value_parser = inclination)]
    pub theta_r: f64,
    /// Azimuth of the viewer from the tangent x
    #[arg(long, value_name = "DEG", default_value = "0", allow_negative_numbers = true, value_parser = angle)]
    pub phi_r: f64,
}

/// `kajo bsdf albedo`.
#[derive(Debug, Args)]
pub struct Albedo {
    /// The model.
    #[command(flatten)]
    pub model: ModelChoice,
    /// Inclinations of the viewer from the normal
    #[arg(long, value_name = "DEG", value_delimiter = ',', default_value = "0,30,60,75,85", value_parser = inclination)]
    pub theta_r: Vec<f64>,
    /// Azimuth of the viewer from the tangent x
    #[arg(long, value_name = "DEG", default_value = "0", allow_negative_numbers = true, value_parser = angle)]
    pub phi_r: f64,
    /// Samples of the sampled estimate
    #[arg(long, value_name = "N", default_value = "100000", value_parser = clap::value_parser!(u32).range(1..=1_000_000_000))]
    pub samples: u32,
}

/// `kajo bsdf fit`.
#[derive(Debug, Args)]
pub struct Fit {
    /// What is fitted, and where it starts.
    #[command(flatten)]
    pub model: ModelChoice,
    /// The model to fit to, over light at 0°, 15° … 75° and viewer at 0°, 10° … 80°
    #[arg(long, value_name = "ID", required_unless_present = "table", conflicts_with = "table")]
    pub to: Option<String>,
    /// A parameter of the model to fit to. Repeatable
    #[arg(long = "to-param", value_name = "NAME=VALUE", num_args = 1.., value_parser = pair, requires = "to")]
    pub to_params: Vec<(String, String)>,
    /// A table to fit to: theta_i,phi_i,theta_r,phi_r,f in degrees and 1/sr, or f_r,f_g,f_b for colours
    #[arg(long, value_name = "FILE.csv")]
    pub table: Option<PathBuf>,
    /// Parameters to change [default: every number]
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    pub free: Vec<String>,
    /// Lobes of Phong's shape to start with, for models of lobes
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=8))]
    pub lobes: Option<u32>,
    /// Keep lobes isotropic, C_x = C_y
    #[arg(long)]
    pub isotropic: bool,
    /// Make small: errors times both cosines, or errors of the logarithm
    #[arg(long, value_enum, default_value = "cos")]
    pub metric: Metric,
    /// How many starts: the values given, and random ones
    #[arg(long, value_name = "N", default_value = "16", value_parser = clap::value_parser!(u32).range(1..=10_000))]
    pub starts: u32,
    /// Relative error to add to the values of the target, for trials
    #[arg(long, value_name = "X", default_value = "0", value_parser = noise)]
    pub noise: f64,
    /// Random numbers start here
    #[arg(long, value_name = "N", default_value = "0")]
    pub seed: u64,
    /// Write the material for a scene in .kajo.toml
    #[arg(long, short, value_name = "FILE")]
    pub output: Option<PathBuf>,
}

/// `kajo bsdf factor`.
#[derive(Debug, Args)]
pub struct Factor {
    /// What is factored.
    #[command(flatten)]
    pub model: ModelChoice,
    /// Without negative numbers, or as a tensor and its residuals
    #[arg(long, value_enum)]
    pub method: Method,
    /// Functions of the viewer (nmf), or functions of each angle in a pass (tucker) [default: 4 for nmf, 2 for tucker]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=64))]
    pub terms: Option<u32>,
    /// Products of functions of the half vector for each function of the viewer; nmf only [default: 2]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=16))]
    pub inner: Option<u32>,
    /// Tensors: that of the values, then of what is left, and so on; tucker only [default: 4]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=256))]
    pub passes: Option<u32>,
    /// Improvements after each term; nmf only [default: 100]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub sweeps: Option<u32>,
    /// The file, for --param file=FILE
    #[arg(long, short, value_name = "FILE")]
    pub output: PathBuf,
}

/// How to factor.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
#[allow(missing_docs, reason = "the names say it")]
pub enum Method {
    Nmf,
    Tucker,
}

/// What a fit makes small.
#[derive(Clone, Copy, Debug, ValueEnum)]
#[allow(missing_docs, reason = "the names say it")]
pub enum Metric {
    Cos,
    Log,
}

fn noise(text: &str) -> Result<f64, String> {
    text.parse().ok().filter(|noise| (0.0..=1.0).contains(noise)).ok_or_else(|| "a relative error is a number from 0 to 1".into())
}

fn pair(text: &str) -> Result<(String, String), String> {
    match text.split_once('=') {
        Some((name, value)) if !name.trim().is_empty() => Ok((name.trim().into(), value.trim().into())),
        _ => Err("a parameter is written name=value".into()),
    }
}

fn angle(text: &str) -> Result<f64, String> {
    text.parse().ok().filter(|angle: &f64| angle.is_finite()).ok_or_else(|| "an angle is a finite number of degrees".into())
}

fn inclination(text: &str) -> Result<f64, String> {
    angle(text).and_then(|angle| {
        if (0.0..=180.0).contains(&angle) {
            Ok(angle)
        } else {
            Err("an inclination is from 0 (the normal) to 180 degrees; over 90 is below the surface".into())
        }
    })
}

fn above(text: &str) -> Result<f64, String> {
    angle(text).and_then(|angle| {
        if (0.0..90.0).contains(&angle) { Ok(angle) } else { Err("the light is above the surface: from 0 to below 90 degrees".into()) }
    })
}
