//! The C ABI of ofc and nothing else: pointers are checked, structs are turned into the core's types, results are
//! written back. `include/ofc.h` is generated from this crate; its doc comments are the manual.
#![no_std]
#![expect(non_camel_case_types, reason = "the names are those of C")]
#![expect(
    clippy::missing_safety_doc,
    reason = "the documentation is for C callers: every call says what it needs"
)]
#![expect(clippy::doc_markdown, reason = "the documentation is the header's, where names are not links")]

mod check;
mod dark;
mod depth;
mod flat_field;
mod freestanding;
mod image;
mod light;
mod offset;
mod orientation;
mod orthogonal;
mod paint;
mod pointers;
mod prelude;
mod reason;
mod regression;
mod relief;
mod render;
mod rig;
mod rig_contact;
mod rig_file;
mod rig_frame;
mod rig_rows;
mod saturation;
mod segment;
mod slants;
mod solve;
mod status;
mod stream;
mod surface;
mod transfer;
mod twin;
mod types;
mod uncertainty;
mod version;

pub use check::*;
pub use dark::*;
pub use depth::*;
pub use flat_field::*;
pub use image::*;
pub use light::*;
pub use offset::*;
pub use orientation::*;
pub use orthogonal::*;
pub use paint::*;
pub use pointers::{OFC_WORKSPACE_ALIGNMENT, ofc_parallel, ofc_part};
pub use reason::*;
pub use regression::*;
pub use relief::*;
pub use render::*;
pub use rig::*;
pub use rig_contact::*;
pub use rig_file::*;
pub use rig_frame::*;
pub use rig_rows::*;
pub use saturation::*;
pub use segment::*;
pub use slants::*;
pub use solve::*;
pub use status::*;
pub use stream::*;
pub use surface::*;
pub use transfer::*;
pub use types::*;
pub use uncertainty::*;
pub use version::*;
