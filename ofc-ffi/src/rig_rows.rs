//! What a solved rig says of a frame row by row, without memory for the frame.

use crate::prelude::*;
use crate::relief::ofc_relief_class;
use crate::rig::ofc_rig_model;
use crate::rig_contact::{LARGEST_PIXEL, ofc_rig_contact};
use ofc_core::orientation::relief::{MOST_ALONG, TERMS as PLANE_TERMS};
use ofc_core::rig::{self, Order, RowError, RowModel, Rows, Seen, TERMS, Wanted};

/// What was seen of a frame so far. Made by ofc_rig_rows_begin(); plain numbers, which may be copied.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct ofc_rig_rows {
    /// The sums of the columns and of the rows of the contact's pixels.
    pub sums: [f64; 2],
    /// One over the color of the model's plane, for the row of cells that was last begun: red, green, blue.
    pub reciprocals: [f32; 720],
    /// The first and last column and row of the contact: left, top, right, bottom.
    pub bounds: [i32; 4],
    /// The cells of the contact in the row of cells that was last begun, a bit each.
    pub contact: [u32; 8],
    /// Its cells of which less than half is usable, a bit each.
    pub missing: [u32; 8],
    /// How many pixels the contact has.
    pub pixels: u32,
    /// How many rows were seen.
    pub rows: i32,
}

plain!(ofc_rig_rows);

const _: () = assert!(3 * MOST_ALONG == 720 && size_of::<ofc_rig_rows>() <= 3 * 1024);

impl From<RowError> for Refusal {
    fn from(error: RowError) -> Self {
        Self(match error {
            RowError::Row => OFC_STATUS_ROW_MISMATCH,
            RowError::TooMany => OFC_STATUS_TOO_MANY_ROWS,
        })
    }
}

/// The numbers of these rows, `N` each.
fn rows_of<const N: usize, const M: usize>(numbers: &[f64]) -> Option<[&[f64; N]; M]> {
    numbers.as_chunks::<N>().0.first_chunk::<M>().map(<[[f64; N]; M]>::each_ref)
}

/// The core's view of a model, which is not copied: stacks are small where rows are used.
fn view_of(model: &ofc_rig_model) -> Result<RowModel<'_>, Refusal> {
    let orders = [Order::Constant, Order::Place, Order::Products];
    let order = orders.into_iter().find(|order| order.len() == dimension(model.terms));
    ensure(order.is_some() || model.terms != 0, OFC_STATUS_NOT_SOLVED)?;
    ensure(pixel_count(model.width, model.height) > 0, OFC_STATUS_INVALID_PARAMETER)?;
    Ok(RowModel {
        width: dimension(model.width),
        height: dimension(model.height),
        order: order.ok_or(OFC_STATUS_INVALID_PARAMETER)?,
        w: rows_of::<TERMS, 2>(&model.slopes).ok_or(OFC_STATUS_INVALID_PARAMETER)?,
        plane: rows_of::<PLANE_TERMS, 3>(&model.plane).ok_or(OFC_STATUS_INVALID_PARAMETER)?,
        noise: model.noise,
        saturation: saturation(model.saturation)?,
    })
}

/// Begins a frame whose rows come one after another.
/// @param rows  Output: nothing was seen.
/// @return OFC_STATUS_OK; an argument status.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_rig_rows_begin(rows: *mut ofc_rig_rows) -> ofc_status {
    // SAFETY: the contract of this function.
    unsafe { Contract::kept() }.call(|call| {
        let rows = call.output(rows)?;
        (rows.sums, rows.bounds, rows.pixels, rows.rows) = ([0.0; 2], [0; 4], 0, 0);
        rows.contact.fill(0);
        rows.missing.fill(0);
        rows.reciprocals.fill(0.0);
        Ok(OFC_STATUS_OK)
    })
}

/// Computes classes and normals of the next row of a frame, without memory for more than that row: with a model that ofc_rig_model_load() gave, for
/// microcontrollers.
///
/// A cell, as wide as one of ofc_rig_classify() and one row high, is touched where it differs from the plane by more than noise together with both
/// beside it. Rows above and below are not looked at: borders are less smooth than those of whole frames. A cell of which less than half is usable,
/// because it is saturated, not finite, masked out or without a background, is not touched. Pixels beyond the last whole cell have the class of that cell.
/// @param model  The solved rig, read in place: the same one for all rows of a frame, its numbers are checked with the first row.
/// @param rows  In and out: the frame so far, from ofc_rig_rows_begin().
/// @param row  A picture of height 1: the row after the last one.
/// @param background  The same row without a contact; NULL to take the plane that the model has, which is right where the frames that the
///     model was made of were added without a background. Where a channel of it is zero, saturated or not finite, there is no usable color.
/// @param classes  Output: width bytes, one of OFC_RELIEF_* for each pixel. NULL where they are not wanted.
/// @param normals  Output: width (n1, n2, n3) floats: (0, 0, 1) on the plane, NaN where there is no usable color. NULL where they are not wanted.
/// @return OFC_STATUS_OK; OFC_STATUS_NOT_SOLVED; OFC_STATUS_ROW_MISMATCH for a row that is not one of the model's width;
///     OFC_STATUS_TOO_MANY_ROWS after the last one; an argument status.
///
/// Stack: below 5 KiB; on a Cortex-M7 without a background below 3 KiB. Reference: docs/rig.md.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_rig_row(
    model: *const ofc_rig_model,
    rows: *mut ofc_rig_rows,
    row: *const ofc_image,
    background: *const ofc_image,
    classes: *mut ofc_relief_class,
    normals: *mut f32,
) -> ofc_status {
    // SAFETY: the contract of this function.
    unsafe { Contract::kept() }.call(|call| {
        let given = call.input_slice(model, 1)?.first().ok_or(OFC_STATUS_INVALID_PARAMETER)?;
        let model = view_of(given)?;
        let rows = call.output(rows)?;
        // The numbers of a model are many: they are looked at once a frame.
        let mut numbers = given.slopes.iter().chain(&given.plane).chain(&given.noise);
        ensure(rows.rows > 0 || numbers.all(|number| number.is_finite()), OFC_STATUS_INVALID_PARAMETER)?;
        let row = call.image(row)?;
        let background = unless_null(background, || call.image(background))?;
        let classes = unless_null(classes, || call.output_slice(classes, model.width))?;
        let normals = unless_null(normals, || call.output_slice(normals, 3 * model.width))?;
        let mut seen = Seen {
            rows: dimension(rows.rows),
            pixels: rows.pixels,
            sums: rows.sums,
            bounds: rows.bounds.map(dimension),
            contact: rows.contact,
            missing: rows.missing,
        };
        let reciprocals = rows.reciprocals.as_chunks_mut().0.first_chunk_mut();
        let mut frame =
            Rows { reciprocals: reciprocals.ok_or(OFC_STATUS_INVALID_PARAMETER)?, seen: &mut seen };
        rig::row(&model, &mut frame, &row, background.as_ref(), &mut Wanted { classes, normals })?;
        (rows.contact, rows.missing) = (seen.contact, seen.missing);
        (rows.rows, rows.pixels, rows.sums) = (seen.rows.to_c(), seen.pixels, seen.sums);
        rows.bounds = seen.bounds.map(|bound| bound.to_c());
        Ok(OFC_STATUS_OK)
    })
}

/// Says what is pressed in, from the rows seen so far.
/// @param rows  The rows.
/// @param pixel_size  The length of a pixel on the gel, positive.
/// @param contact  Output: area, center and bounds of the pixels of the class OFC_RELIEF_CONTACT. Without depth nothing is known of peak and volume: they are NaN, and the place of the peak is -1, -1.
/// @return OFC_STATUS_OK; OFC_STATUS_NO_RELIEF, with nothing written, where there is no contact; an argument status.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_rig_rows_contact(
    rows: *const ofc_rig_rows,
    pixel_size: f64,
    contact: *mut ofc_rig_contact,
) -> ofc_status {
    // SAFETY: the contract of this function.
    unsafe { Contract::kept() }.call(|call| {
        let rows = call.input_slice(rows, 1)?.first().ok_or(OFC_STATUS_INVALID_PARAMETER)?;
        let contact = call.output(contact)?;
        ensure(pixel_size > 0.0 && pixel_size < LARGEST_PIXEL, OFC_STATUS_INVALID_PARAMETER)?;
        if rows.pixels == 0 {
            return Ok(OFC_STATUS_NO_RELIEF);
        }
        let pixels = f64::from(rows.pixels);
        *contact = ofc_rig_contact {
            area: pixels * pixel_size * pixel_size,
            center: rows.sums.map(|sum| sum / pixels),
            peak: f64::NAN,
            volume: f64::NAN,
            peak_place: [-1; 2],
            bounds: rows.bounds,
        };
        Ok(OFC_STATUS_OK)
    })
}
