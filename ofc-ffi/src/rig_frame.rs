//! What a solved rig says of a frame.

use crate::prelude::*;
use crate::relief::{normals_writer, ofc_relief_class};
use crate::rig::{ofc_rig_model, rig_refusal};
use ofc_core::orientation::relief;
use ofc_core::rig::{self, Model};

/// Says what each pixel of a frame is part of: the plane, the contact, its skirt. A frame without a contact is all plane.
/// @param model  The solved rig.
/// @param image  The frame.
/// @param background  A frame of the same rig without a contact, as it is now; NULL to take the plane that the model has.
/// @param workspace  ofc_relief_workspace_size() bytes, aligned to OFC_WORKSPACE_ALIGNMENT.
/// @param workspace_bytes  How long the workspace is.
/// @param classes  Output: width x height bytes, rows without gaps: one of OFC_RELIEF_* for each pixel.
/// @return OFC_STATUS_OK; OFC_STATUS_NOT_SOLVED; OFC_STATUS_TOO_FEW_PIXELS; an argument status, OFC_STATUS_INVALID_PARAMETER for a frame of
///     another size.
///
/// Stack: below 16 KiB.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_rig_classify(
    model: *const ofc_rig_model,
    image: *const ofc_image,
    background: *const ofc_image,
    workspace: *mut c_void,
    workspace_bytes: usize,
    classes: *mut ofc_relief_class,
) -> ofc_status {
    // SAFETY: the contract of this function.
    unsafe { Contract::kept() }.call(|call| {
        let model: Model = call.params(model)?;
        let image = call.image(image)?;
        let background = unless_null(background, || call.image(background))?;
        let [width, height] = size(&image);
        ensure([width, height] == [model.width, model.height], OFC_STATUS_INVALID_PARAMETER)?;
        let need = relief::need(width, height).ok_or(OFC_STATUS_EMPTY)?;
        let workspace = call.arena(workspace, workspace_bytes, need)?;
        let classes = call.output_slice(classes, width * height)?;
        rig::classify(&model, &image, background.as_ref(), workspace, classes).map_err(rig_refusal)?;
        Ok(OFC_STATUS_OK)
    })
}

/// Computes the unit normals of a frame, and how sure each of them is.
/// @param model  The solved rig.
/// @param image  The frame.
/// @param background  As for ofc_rig_classify().
/// @param classes  Its classes, width x height bytes.
/// @param normals  Output: height rows of width (n1, n2, n3) floats: (0, 0, 1) on the plane, NaN where there is no usable color.
/// @param normals_stride_bytes  Bytes from one row to the next, a multiple of 4.
/// @param uncertainty  Output: height rows of width floats, the standard deviation of the angle in radians: 0 on the plane, NaN where
///     there is no normal. NULL where it is not wanted.
/// @param uncertainty_stride_bytes  Bytes from one row to the next, a multiple of 4; not read where `uncertainty` is NULL.
/// @return OFC_STATUS_OK; OFC_STATUS_NOT_SOLVED; an argument status, OFC_STATUS_INVALID_PARAMETER for a frame of another size.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_rig_normals(
    model: *const ofc_rig_model,
    image: *const ofc_image,
    background: *const ofc_image,
    classes: *const ofc_relief_class,
    normals: *mut f32,
    normals_stride_bytes: usize,
    uncertainty: *mut f32,
    uncertainty_stride_bytes: usize,
) -> ofc_status {
    // SAFETY: the contract of this function.
    unsafe { Contract::kept() }.call(|call| {
        let model: Model = call.params(model)?;
        let image = call.image(image)?;
        let background = unless_null(background, || call.image(background))?;
        let size = size(&image);
        let [width, height] = size;
        let classes = call.input_slice(classes, width * height)?;
        let normals = call.output_rows(normals, size, 3, normals_stride_bytes)?;
        let deviations =
            unless_null(uncertainty, || call.output_rows(uncertainty, size, 1, uncertainty_stride_bytes))?;
        ensure(size == [model.width, model.height], OFC_STATUS_INVALID_PARAMETER)?;
        let write = normals_writer(normals, deviations);
        rig::normals(&model, &image, background.as_ref(), classes, write).map_err(rig_refusal)?;
        Ok(OFC_STATUS_OK)
    })
}
