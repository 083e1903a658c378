//! The picture: a wgpu renderer for a frame given as plain data, with or without a window.
//!
//! [`frame::Frame`] says what to draw, [`renderer::Renderer`] draws it, [`capture`] reads it back, [`window`] shows it.
//! Positions are the world's in f64 and become relative to the eye before they are rounded (see [`camera`]); colour is
//! linear and exposed until one tone map at the end of every fragment shader (see [`sky`] for the light).
//! This crate knows no simulation.
#![forbid(unsafe_code)]

pub mod camera;
pub mod capture;
pub mod frame;
mod glyphs;
pub mod gpu;
pub mod models;
pub mod moon;
pub mod particles;
pub mod passes;
pub mod proof;
pub mod renderer;
pub mod shaders;
pub mod sky;
mod sky_feed;
pub mod sun;
pub mod uniforms;
pub mod window;

pub use frame::{Frame, Scene};
pub use gpu::{Gpu, GpuError};
pub use renderer::{Layer, Renderer, SceneView, Settings};

// Named in signatures; whoever draws needs no wgpu of its own.
pub use wgpu::{RenderPass, Texture, TextureFormat, TextureView};
