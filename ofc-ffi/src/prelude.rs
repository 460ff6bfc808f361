//! What the modules of this crate share: the names of C, and what turns them into those of the core.

pub(crate) use crate::pointers::{
    Call, Contract, Plain, Threads, bytes, ofc_parallel, plain, text_of, unless_null,
};
pub(crate) use crate::twin::{FromC, ToC, constants, from_c, to_c};
pub(crate) use crate::{
    check::*, image::*, light::*, orientation::*, render::*, slants::*, solve::*, status::*, types::*,
};
pub(crate) use core::ffi::c_void;
pub(crate) use ofc_core::math::arena::Need;
