//! What must hold of a file's layout before any of its elements is read: the reader behind [`super`] takes it for granted.

use super::{GlbError, MAX_CORNERS, wrong};
use gltf::accessor::{DataType, Dimensions};
use gltf::{Accessor, Semantic};

/// Whether all that triangles read lies in the file's own buffer and has a type that it can be read as.
pub(super) fn layout(file: &gltf::Gltf, blob: &[u8]) -> Result<(), GlbError> {
    for view in file.views() {
        let end = view.offset().checked_add(view.length());
        if !matches!(view.buffer().source(), gltf::buffer::Source::Bin) || end.is_none_or(|end| end > blob.len()) {
            return Err(wrong("views inside the file's own buffer", format_args!("view {} beyond it", view.index())));
        }
    }
    for accessor in file.accessors() {
        elements(&accessor)?;
    }
    let triangles = |primitive: &gltf::Primitive<'_>| primitive.mode() == gltf::mesh::Mode::Triangles;
    for primitive in file.meshes().flat_map(|mesh| mesh.primitives().collect::<Vec<_>>()).filter(triangles) {
        for (semantic, accessor) in primitive.attributes() {
            match semantic {
                Semantic::Positions | Semantic::Normals => typed(&accessor, &[DataType::F32], Dimensions::Vec3)?,
                Semantic::TexCoords(_) => {
                    typed(&accessor, &[DataType::U8, DataType::U16, DataType::F32], Dimensions::Vec2)?;
                }
                _ => {}
            }
        }
        if let Some(indices) = primitive.indices() {
            typed(&indices, &[DataType::U8, DataType::U16, DataType::U32], Dimensions::Scalar)?;
        }
    }
    Ok(())
}

fn typed(accessor: &Accessor<'_>, types: &[DataType], dimensions: Dimensions) -> Result<(), GlbError> {
    if types.contains(&accessor.data_type()) && accessor.dimensions() == dimensions {
        return Ok(());
    }
    let found =
        format_args!("{:?} of {:?} in accessor {}", accessor.dimensions(), accessor.data_type(), accessor.index())
            .to_string();
    Err(wrong(&format!("{dimensions:?} of {types:?}"), found))
}

/// Whether all of an accessor's elements lie in its view, one behind another.
fn elements(accessor: &Accessor<'_>) -> Result<(), GlbError> {
    let number = accessor.index();
    if !(1..=MAX_CORNERS).contains(&accessor.count()) {
        return Err(wrong(
            &format!("1 to {MAX_CORNERS} elements"),
            format_args!("{} in accessor {number}", accessor.count()),
        ));
    }
    if accessor.sparse().is_some() {
        return Err(wrong("plain accessors", format_args!("accessor {number} is sparse")));
    }
    let view = accessor.view().ok_or_else(|| wrong("accessors with a view", format_args!("{number} without")))?;
    let size = accessor.size();
    let stride = view.stride().unwrap_or(size);
    if stride < size {
        return Err(wrong(&format!("a stride of {size} bytes or more"), format_args!("{stride} in accessor {number}")));
    }
    let end = (accessor.count() - 1)
        .checked_mul(stride)
        .and_then(|last| last.checked_add(accessor.offset())?.checked_add(size));
    match end {
        Some(end) if end <= view.length() => Ok(()),
        _ => Err(wrong(&format!("{} bytes of accessor {number}", view.length()), format_args!("a need of {end:?}"))),
    }
}
