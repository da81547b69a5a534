use super::*;
use crate::models::factored::testing::{SMALL, random};
use crate::models::testing::{extreme_pair, model};
use crate::models::{Form, factored, merl, nmf, rgl, tucker};
use std::sync::Arc;

type Chosen = (&'static str, &'static [(&'static str, &'static str)]);

const WARD: Chosen = ("ward", &[("kd", "0.3,0.2,0.1"), ("ks", "0.4,0.5,0.6"), ("m", "0.2")]);
const BRUSHED: Chosen = ("ggx", &[("alpha_x", "0.2"), ("alpha_y", "0.5"), ("f0", "0.9,0.5,0.2")]);

fn analytic((id, pairs): Chosen) -> Arc<dyn Reflectance> {
    model(id, pairs, Form::Corrected)
}

/// Terms of a factored table that the coordinates can follow: narrow in θ_h, a little uneven in φ_h and from viewer to viewer.
fn smooth(count: usize, low: f32, seed: u64) -> Vec<f32> {
    let noise = random(count, 0.8, seed);
    noise.iter().map(|x| low + (1.0 - low) * x).collect()
}

fn nmf(grid: factored::Grid) -> Arc<dyn Reflectance> {
    let (outer, inner) = (1, 2);
    let lobe = (0..outer * inner * grid.theta_h).map(|k| (-0.05 * ((k % grid.theta_h) as f32).powi(2)).exp());
    Arc::new(
        nmf::Factors {
            grid,
            diffuse: random(grid.channels, 0.5, 1),
            outer,
            inner,
            views: smooth(outer * grid.viewers() * grid.channels, 0.2, 2),
            inclinations: lobe.collect(),
            azimuths: smooth(outer * inner * grid.phi_h, 0.2, 4),
        }
        .into_model(),
    )
}

fn tucker(grid: factored::Grid) -> Arc<dyn Reflectance> {
    let (nodes, ranks) = (tucker::nodes(grid), tucker::ranks(grid, 2));
    let pass = |seed: u64| tucker::Pass {
        functions: std::array::from_fn(|mode| smooth(nodes[mode] * ranks[mode], 0.2, 10 * seed + mode as u64)),
        core: random(ranks.iter().product(), 0.0, 10 * seed + 9),
    };
    Arc::new(tucker::Factors { grid, diffuse: random(grid.channels, 0.5, 5), rank: 2, passes: vec![pass(1)] }.into_model())
}

/// Name, model, the grid it should get, and limits of [`worst`].
type Measured = (&'static str, Arc<dyn Reflectance>, Grid, [f32; 2]);

fn measured() -> Vec<Measured> {
    let merl = merl::Table::of_model(&*analytic(WARD));
    let rgl = |chosen, resolution| Arc::new(rgl::Rgl::new(rgl::Table::of_model(&*analytic(chosen), resolution)));
    let few = rgl::Resolution { phi_i: 17, theta_i: 10, samples: 24, ..rgl::Resolution::ANISOTROPIC };
    vec![
        ("merl", Arc::new(merl::Merl::new(merl.clone(), merl::Interpolation::Linear)), Grid::ISOTROPIC, [0.008, 0.008]),
        ("merl nearest", Arc::new(merl::Merl::new(merl, merl::Interpolation::Nearest)), Grid::ISOTROPIC, [0.1, 0.13]),
        ("rgl", rgl(WARD, rgl::Resolution::ISOTROPIC), Grid::ISOTROPIC, [0.008, 0.03]),
        ("rgl anisotropic", rgl(BRUSHED, few), Grid::ANISOTROPIC, [0.05, 0.13]),
        ("nmf", nmf(SMALL[0]), Grid::ISOTROPIC, [0.06, 0.01]),
        ("nmf anisotropic", nmf(SMALL[1]), Grid::ANISOTROPIC, [0.25, 0.1]),
        ("tucker", tucker(SMALL[0]), Grid::ISOTROPIC, [0.08, 0.06]),
        ("tucker anisotropic", tucker(SMALL[1]), Grid::ANISOTROPIC, [0.25, 0.13]),
    ]
}

/// [`Tabulated::deviation`], and the largest difference of f cos θ_i more than 5° above the surface by the largest value there.
fn worst(table: &Tabulated, model: &dyn Reflectance) -> [f32; 2] {
    let (off, largest) = pairs().filter(|(wi, wo)| wi.z > 0.087 && wo.z > 0.087).fold((0.0_f32, 0.0_f32), |(off, largest), (wi, wo)| {
        let expected = model.rendered_f_cos(wi, wo);
        (off.max((table.f_cos(wi, wo) - expected).abs().max_element()), largest.max(expected.max_element()))
    });
    [table.deviation(model), off / largest]
}

/// Asserts both numbers of [`worst`].
#[track_caller]
fn assert_near(what: &str, model: &dyn Reflectance, grid: Grid, limits: [f32; 2]) {
    assert_eq!(Grid::of(model), grid, "{what}");
    let got = worst(&Tabulated::new(model, grid), model);
    assert!(got[0] < limits[0] && got[1] < limits[1], "{what}: {got:?}, limits {limits:?}");
}

/// What interpolation costs, by lobes from slope 0.05 to matt surfaces. Cook and Torrance's masking has edges in θ_d; Phong's highlight is no function of
/// the half vector.
#[test]
fn tables_of_formulas_are_near_to_them() {
    for (chosen, limits) in [
        (("lambert", &[][..]), [0.0015, 0.004]),
        (WARD, [0.003, 0.002]),
        (("ward", &[("m", "0.05")]), [0.002, 0.003]),
        (("ggx", &[("alpha", "0.1")]), [0.004, 0.004]),
        (("ggx", &[("alpha", "0.3")]), [0.004, 0.002]),
        (("cook-torrance", &[("m", "0.3")]), [0.08, 0.02]),
        (("phong-bsf", &[]), [0.03, 0.025]),
    ] {
        assert_near(chosen.0, &*analytic(chosen), Grid::ISOTROPIC, limits);
    }
    for (chosen, limits) in [(BRUSHED, [0.015, 0.03]), (("ggx", &[("alpha_x", "0.1"), ("alpha_y", "0.3")]), [0.03, 0.02])] {
        assert_near(chosen.0, &*analytic(chosen), Grid::ANISOTROPIC, limits);
    }
    let (ward, other) = (analytic(WARD), analytic(("ward", &[("kd", "0.3,0.2,0.1"), ("ks", "0.4,0.5,0.6"), ("m", "0.21")])));
    let fault = worst(&Tabulated::new(&*ward, Grid::ISOTROPIC), &*other);
    assert!(fault[0] > 0.02 && fault[1] > 0.02, "planted fault: {fault:?}");
}

/// Tables of files have edges of their own at their nodes; `nearest` is nothing but edges. The factored ones, of five viewers and noise, are large at the
/// horizon, where their deviation is.
#[test]
fn tables_of_files_are_near_to_them() {
    for (what, model, grid, limits) in measured() {
        assert_near(what, &*model, grid, limits);
    }
}

#[test]
fn at_a_node_the_table_is_its_model() {
    for (chosen, fault) in
        [(WARD, ("ward", &[("m", "0.2"), ("kd", "0.31")][..])), (BRUSHED, ("ggx", &[("alpha_x", "0.5"), ("alpha_y", "0.2")]))]
    {
        let model = analytic(chosen);
        let table = Tabulated::new(&*model, Grid::of(&*model));
        let off = |model: &dyn Reflectance| {
            (0..table.grid.nodes()).step_by(997).map(|node| table.grid.coordinates(node)).fold(0.0_f32, |off, at| {
                if !(0.02..0.95).contains(&at.theta_d) || !(0.02..0.95).contains(&at.theta_h) {
                    return off;
                }
                let (wi, wo) = at.directions();
                let expected = model.rendered_f_cos(wi, wo);
                off.max(((table.f_cos(wi, wo) - expected) / expected).abs().max_element())
            })
        };
        assert!(off(&*model) < 2e-3, "{chosen:?}: {}", off(&*model));
        assert!(off(&*analytic(fault)) > 2e-3, "planted fault");
    }
}

#[test]
fn extreme_directions_have_finite_values() {
    let mut rng = Rng::new(4);
    for chosen in [WARD, BRUSHED] {
        let table = Tabulated::new(&*analytic(chosen), Grid { theta_h: 8, phi_h: 4, phi_d: 8, theta_d: 4 });
        for k in 0..20_000 {
            let (wi, wo) = extreme_pair(&mut rng, k);
            let value = table.f_cos(wi.as_vec3(), wo.as_vec3());
            assert!(value.is_finite() && value.min_element() >= 0.0, "{wi} {wo}: {value}");
        }
    }
}
