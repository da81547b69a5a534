//! How far an image is from its reference, and how far the reference itself can be trusted.
//!
//! [`Comparison`] gathers every number; the modules give each alone. A reference is a measurement: with its variance known, an error
//! below [`rmse_floor`] is not an error of the image, and [`mse_difference`] says whether two images can be told apart at all. Sums are
//! in `f64` and in pixel order, so results do not depend on the number of threads.

mod bias_noise;
mod comparison;
mod crops;
mod error;
pub mod flip;
mod floor;
mod heat_map;
mod pointwise;
mod scatter;
mod shadow_class;
mod ssim;
mod view;
mod visibility;
mod z_test;

pub use bias_noise::{BiasNoise, bias_noise};
pub use comparison::{Comparison, ComparisonOptions};
pub use crops::{Crop, crop, worst_crops};
pub use error::MetricsError;
pub use floor::{MseDifference, is_above_floor, mse_difference, rmse_floor};
pub use heat_map::{Palette, heat_map};
pub use pointwise::{REL_MSE_EPSILON, error_image, mean_ratio, mse, psnr, rel_mse, rmse};
pub use scatter::{Scatter, scatter};
pub use shadow_class::{ClassConfusion, ClassShares, ShadowClass, TOLERANCE, class_picture, shadow_classes};
pub use ssim::ssim;
pub use view::{Transfer, View};
pub use visibility::{ShadowBorder, border_distance, distance_to, shadow_border};
pub use z_test::{ZTest, z_test};

#[cfg(test)]
mod test_images;
