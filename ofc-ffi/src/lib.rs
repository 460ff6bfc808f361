#![cfg_attr(not(feature = "std"), no_std)]
//! The C ABI of ofc.
