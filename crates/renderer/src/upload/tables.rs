//! Models that are read from files, which have no formula for shaders: tabulated here, once for all materials that share one.

use kajo_bsdf::models::tabulated::{Grid, Tabulated};
use kajo_scene::{ReflectanceModel, Scene};
use kajo_shader_lib::BsdfTables;

/// What is known of the tables of a scene.
pub(crate) struct ModelTables(Vec<ModelTable>);

/// A model as shaders have it.
pub(crate) struct ModelTable {
    model: ReflectanceModel,
    /// Of the materials that use it.
    pub constants: Vec<f32>,
    pub grid: Grid,
    /// What is lost; see [`Tabulated::deviation`].
    pub deviation: f32,
}

impl ModelTables {
    /// Tabulates every model of the scene's materials that has no formula for shaders; with what is to be uploaded.
    pub fn new(scene: &Scene) -> (Self, BsdfTables) {
        let (mut out, mut buffer) = (Self(Vec::new()), BsdfTables::new());
        for model in scene.materials.iter().filter_map(|material| material.model.as_ref()) {
            if model.entry.wesl.is_none() && out.of(model).is_none() {
                let grid = Grid::of(&*model.reflectance);
                let table = Tabulated::new(&*model.reflectance, grid);
                let deviation = table.deviation(&*model.reflectance);
                out.0.push(ModelTable { model: model.clone(), constants: buffer.add(&table), grid, deviation });
            }
        }
        (out, buffer)
    }

    /// The table of a model, where it has one.
    pub fn of(&self, model: &ReflectanceModel) -> Option<&ModelTable> {
        self.0.iter().find(|table| table.model == *model)
    }
}
