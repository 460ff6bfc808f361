//! A solved rig as bytes.

use crate::prelude::*;
use crate::rig::ofc_rig_model;
use ofc_core::rig::{self, FILE_BYTES, FileError, Model};

/// The bytes of a saved model.
pub const OFC_RIG_MODEL_BYTES: usize = 1368;

const _: () = assert!(OFC_RIG_MODEL_BYTES == FILE_BYTES, "the header says what the core does");

impl From<FileError> for Refusal {
    fn from(error: FileError) -> Self {
        Self(match error {
            FileError::Kind => OFC_STATUS_NOT_A_MODEL,
            FileError::Version => OFC_STATUS_MODEL_VERSION,
            FileError::Size | FileError::Damaged => OFC_STATUS_MODEL_DAMAGED,
            FileError::Numbers => OFC_STATUS_INVALID_PARAMETER,
        })
    }
}

/// Writes a model as bytes that are the same on every target: magic number, byte order, version, size, numbers, checksum.
/// @param model  The solved rig.
/// @param bytes  Output: OFC_RIG_MODEL_BYTES bytes.
/// @param size  How long `bytes` is.
/// @return OFC_STATUS_OK; OFC_STATUS_NOT_SOLVED; OFC_STATUS_WORKSPACE_TOO_SMALL where `bytes` is too short; an argument status.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_rig_model_save(
    model: *const ofc_rig_model,
    bytes: *mut u8,
    size: usize,
) -> ofc_status {
    // SAFETY: the contract of this function.
    unsafe { Contract::kept() }.call(|call| {
        let model: Model = call.params(model)?;
        ensure(size >= FILE_BYTES, OFC_STATUS_WORKSPACE_TOO_SMALL)?;
        let bytes = call.output_array::<u8, FILE_BYTES>(bytes)?;
        rig::save(&model, bytes);
        Ok(OFC_STATUS_OK)
    })
}

/// Reads a model that ofc_rig_model_save() wrote, on this target or another one. Whatever the bytes are, they are a model or refused.
/// @param bytes  The bytes.
/// @param size  How many they are.
/// @param model  Output: the model.
/// @return OFC_STATUS_OK; OFC_STATUS_NOT_A_MODEL for other bytes; OFC_STATUS_MODEL_VERSION; OFC_STATUS_MODEL_DAMAGED for a wrong size or checksum;
///     an argument status, OFC_STATUS_INVALID_PARAMETER for numbers that no model has.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn ofc_rig_model_load(
    bytes: *const u8,
    size: usize,
    model: *mut ofc_rig_model,
) -> ofc_status {
    // SAFETY: the contract of this function.
    unsafe { Contract::kept() }.call(|call| {
        ensure(size > 0, OFC_STATUS_EMPTY)?;
        let bytes = call.input_slice(bytes, size)?;
        let out = call.output(model)?;
        let loaded = rig::load(bytes)?;
        checked_pixel_count(loaded.width.to_c(), loaded.height.to_c())?;
        *out = loaded.to_c();
        Ok(OFC_STATUS_OK)
    })
}
