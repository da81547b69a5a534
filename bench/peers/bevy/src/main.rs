//! Frames of one glTF under one directional light by Bevy, without a window. Prints milliseconds as JSON: the median frame, and the median of every span
//! that Bevy times on the device.
//!
//! `bevy-passes FILE.gltf MODE WIDTH HEIGHT SHADOW_MAP FRAMES FOV EX,EY,EZ TX,TY,TZ LX,LY,LZ [PICTURE.png]` with MODE one of `plain`, `cascades`, `contact`,
//! `ssao`, `taa`, `taa-8-bit`; E the eye, T the target, L the direction in which light shines, FOV in degrees.

use bevy::anti_alias::taa::TemporalAntiAliasing;
use bevy::camera::{Hdr, RenderTarget};
use bevy::camera::primitives::Aabb;
use bevy::camera::visibility::VisibilityClass;
use bevy::core_pipeline::prepass::{DeferredPrepass, DepthPrepass, MotionVectorPrepass};
use bevy::core_pipeline::tonemapping::Tonemapping;
use bevy::diagnostic::DiagnosticsStore;
use bevy::gltf::{GltfExtras, GltfMaterialExtras, GltfMaterialName, GltfMeshExtras, GltfMeshName, GltfSceneExtras, GltfSceneName};
use bevy::light::{CascadeShadowConfigBuilder, DirectionalLightShadowMap, ShadowFilteringMethod};
use bevy::pbr::{ContactShadows, DefaultOpaqueRendererMethod, ScreenSpaceAmbientOcclusion};
use bevy::prelude::*;
use bevy::render::diagnostic::RenderDiagnosticsPlugin;
use bevy::render::pipelined_rendering::PipelinedRenderingPlugin;
use bevy::render::render_resource::{PollType, TextureFormat};
use bevy::render::renderer::RenderDevice;
use bevy::render::view::screenshot::{Screenshot, save_to_disk};
use bevy::transform::components::TransformTreeChanged;
use std::collections::BTreeMap;
use std::path::Path;
use std::time::{Duration, Instant};

/// Frames before the clock counts: the file is read, pipelines are compiled.
const WARM_UP: u32 = 60;

fn vector(text: &str) -> Vec3 {
    let numbers: Vec<f32> = text.split(',').map(|n| n.parse().expect("a number")).collect();
    Vec3::from_slice(&numbers)
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

fn main() {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let [file, mode, width, height, map, frames, fov, eye, target, light] = &words[..10] else { panic!("ten arguments") };
    let path = Path::new(file).canonicalize().expect("the file is there");
    let folder = path.parent().expect("a folder").to_str().expect("UTF-8").to_owned();
    let name = path.file_name().expect("a file").to_str().expect("UTF-8").to_owned();
    let number = |text: &String| text.parse::<u32>().expect("a number");

    let mut app = App::new();
    let assets = AssetPlugin { file_path: folder, ..default() };
    app.add_plugins(DefaultPlugins.set(assets).disable::<PipelinedRenderingPlugin>());
    app.add_plugins(RenderDiagnosticsPlugin);
    app.insert_resource(DirectionalLightShadowMap { size: number(map) as usize });
    app.insert_resource(DefaultOpaqueRendererMethod::deferred());
    app.insert_resource(GlobalAmbientLight::NONE);
    // What a glTF's entities consist of: without Bevy's automatic registration it is named here.
    app.register_type::<Transform>().register_type::<GlobalTransform>().register_type::<TransformTreeChanged>();
    app.register_type::<Visibility>()
        .register_type::<InheritedVisibility>()
        .register_type::<ViewVisibility>()
        .register_type::<VisibilityClass>();
    app.register_type::<Name>().register_type::<ChildOf>().register_type::<Children>().register_type::<Aabb>();
    app.register_type::<Mesh3d>().register_type::<MeshMaterial3d<StandardMaterial>>();
    app.register_type::<GltfMaterialName>().register_type::<GltfMeshName>().register_type::<GltfSceneName>().register_type::<GltfExtras>();
    app.register_type::<GltfMaterialExtras>().register_type::<GltfMeshExtras>().register_type::<GltfSceneExtras>();
    app.finish();
    app.cleanup();

    let scene = app.world().resource::<AssetServer>().load(GltfAssetLabel::Scene(0).from_asset(name));
    let image = Image::new_target_texture(number(width), number(height), TextureFormat::Rgba8UnormSrgb, None);
    let image = app.world_mut().resource_mut::<Assets<Image>>().add(image);
    let world = app.world_mut();
    world.spawn(WorldAssetRoot(scene));
    let shadows = mode == "cascades" || mode == "contact";
    world.spawn((
        DirectionalLight { illuminance: 10_000.0, shadow_maps_enabled: shadows, contact_shadows_enabled: mode == "contact", ..default() },
        CascadeShadowConfigBuilder { num_cascades: 4, first_cascade_far_bound: 0.5, maximum_distance: 4.0, ..default() }.build(),
        Transform::default().looking_to(vector(light), Vec3::Y),
    ));
    let camera = world
        .spawn((
            Camera3d::default(),
            RenderTarget::Image(image.clone().into()),
            Projection::Perspective(PerspectiveProjection {
                fov: fov.parse::<f32>().expect("degrees").to_radians(),
                near: 0.01,
                ..default()
            }),
            Transform::from_translation(vector(eye)).looking_at(vector(target), Vec3::Y),
            Msaa::Off,
            Tonemapping::Reinhard,
            ShadowFilteringMethod::Gaussian,
            (DepthPrepass, DeferredPrepass, MotionVectorPrepass),
        ))
        .id();
    match mode.as_str() {
        "plain" | "cascades" => {}
        "contact" => drop(world.entity_mut(camera).insert(ContactShadows::default())),
        "ssao" => drop(world.entity_mut(camera).insert(ScreenSpaceAmbientOcclusion::default())),
        // Kajo's pictures are linear radiance: so are Bevy's with `Hdr`.
        "taa" => drop(world.entity_mut(camera).insert((TemporalAntiAliasing::default(), Hdr))),
        "taa-8-bit" => drop(world.entity_mut(camera).insert(TemporalAntiAliasing::default())),
        other => panic!("no mode {other}"),
    }

    let mut whole = Vec::new();
    let mut spans: BTreeMap<String, Vec<f64>> = BTreeMap::new();
    for frame in 0..WARM_UP + number(frames) {
        let begin = Instant::now();
        app.update();
        app.world().resource::<RenderDevice>().poll(PollType::wait_indefinitely()).expect("the device answers");
        if frame < WARM_UP {
            // Files are read by threads of their own.
            std::thread::sleep(Duration::from_millis(50));
            continue;
        }
        whole.push(begin.elapsed().as_secs_f64() * 1e3);
        for diagnostic in app.world().resource::<DiagnosticsStore>().iter() {
            let path = diagnostic.path().as_str();
            if let (true, Some(value)) = (path.ends_with("elapsed_gpu"), diagnostic.value()) {
                spans.entry(path.to_owned()).or_default().push(value);
            }
        }
    }
    let spans: BTreeMap<String, f64> = spans.into_iter().map(|(path, values)| (path, median(values))).collect();
    println!("{}", serde_json::json!({ "mode": mode, "frame_ms": median(whole), "spans_ms": spans }));

    if let Some(picture) = words.get(10) {
        app.world_mut().spawn(Screenshot::image(image)).observe(save_to_disk(picture.clone()));
        for _ in 0..20 {
            app.update();
            std::thread::sleep(Duration::from_millis(50));
        }
    }
}
