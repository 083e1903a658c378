//! The WGSL sources, embedded, and joined where one includes another.
//!
//! A line `//!include "shared/name.wgsl"` is replaced by that file; includes do not nest. That is all the language
//! there is: a shader and what it includes can be read as they are.

/// Every entry shader by file name.
pub const SOURCES: &[(&str, &str)] = &[
    ("canopy.wgsl", include_str!("../../shaders/canopy.wgsl")),
    ("heights.wgsl", include_str!("../../shaders/heights.wgsl")),
    ("lights.wgsl", include_str!("../../shaders/lights.wgsl")),
    ("lines.wgsl", include_str!("../../shaders/lines.wgsl")),
    ("plants.wgsl", include_str!("../../shaders/plants.wgsl")),
    ("overlay.wgsl", include_str!("../../shaders/overlay.wgsl")),
    ("objects.wgsl", include_str!("../../shaders/objects.wgsl")),
    ("particles.wgsl", include_str!("../../shaders/particles.wgsl")),
    ("sky.wgsl", include_str!("../../shaders/sky.wgsl")),
    ("terrain.wgsl", include_str!("../../shaders/terrain.wgsl")),
    ("upscale.wgsl", include_str!("../../shaders/upscale.wgsl")),
];

/// Every file that may be included.
pub const SHARED: &[(&str, &str)] = &[
    ("shared/detail.wgsl", include_str!("../../shaders/shared/detail.wgsl")),
    ("shared/display.wgsl", include_str!("../../shaders/shared/display.wgsl")),
    ("shared/frame.wgsl", include_str!("../../shaders/shared/frame.wgsl")),
    ("shared/light.wgsl", include_str!("../../shaders/shared/light.wgsl")),
    ("shared/posts.wgsl", include_str!("../../shaders/shared/posts.wgsl")),
    ("shared/sky.wgsl", include_str!("../../shaders/shared/sky.wgsl")),
    ("shared/water.wgsl", include_str!("../../shaders/shared/water.wgsl")),
];

/// The whole text of a shader by name. An unknown name gives a text that no compiler accepts and that says what was
/// missing; a test joins and compiles every source, so it is not met outside tests.
pub fn joined(name: &str) -> String {
    match SOURCES.iter().find(|(known, _)| *known == name) {
        Some((_, source)) => join(source),
        None => format!("expected one of the embedded shaders, found {name}"),
    }
}

/// A source with its include lines replaced.
pub fn join(source: &str) -> String {
    let mut text = String::with_capacity(2 * source.len());
    for line in source.lines() {
        let included = line.trim().strip_prefix("//!include \"").and_then(|rest| rest.strip_suffix('"'));
        match included {
            None => text.push_str(line),
            Some(wanted) => match SHARED.iter().find(|(known, _)| *known == wanted) {
                Some((_, shared)) => text.push_str(shared),
                None => text.push_str(&format!("expected one of the shared shaders, found {wanted}")),
            },
        }
        text.push('\n');
    }
    text
}

/// Compiles a shader for the device.
pub fn module(device: &wgpu::Device, name: &str) -> wgpu::ShaderModule {
    device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some(name),
        source: wgpu::ShaderSource::Wgsl(joined(name).into()),
    })
}
