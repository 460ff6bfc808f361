//! A rig: camera, lights and surface stay, as those of a tactile sensor do, and only what is pressed in changes.
//!
//! The model is that of [`relief`](crate::orientation::relief): with delta the color relative to the untouched plane,
//! (n1, n2) = W phi and n3 = sqrt(1 - n1^2 - n2^2). What a single frame says of W adds up over frames:
//!
//! 1. [`Rig`] holds sums that need no label, 1 KiB for any number of frames: circulation, energy, which way is out, and how the colors bend.
//!    They give W as a constant 2 x 3 matrix, up to its scale.
//! 2. [`Balls`] holds sums over presses of balls of known radius, with or without their centers. On a ball n1 = (x - x0) / r, which makes W
//!    a regression: of delta alone, of delta times a polynomial of order 2 of the place, or of the products of delta as well.
//! 3. [`solve()`] makes a [`Model`] of both. Sums of rigs of one sensor add: [`Rig::merge`], [`BallsMut::merge`].
//!
//! A model turns frames into [classes](classify) and [normals](normals()); [`follow`] keeps the background as it drifts, [`contact()`] measures what
//! is pressed in, and [`save`] and [`load`] keep a model.
//!
//! The scale of W comes from balls, from what the caller knows, or from the bend of the colors; otherwise it is unknown, and said to be.

mod background;
mod ball;
mod contact;
mod file;
mod frame;
mod model;
mod row;
mod rows;
mod solve;
mod sums;
mod terms;

pub use background::follow;
pub use ball::{Ball, Balls, BallsMut, PACKED, SIDES};
pub use contact::{Contact, contact};
pub use file::{FILE_BYTES, FileError, load, save};
pub use frame::{Frame, add};
pub use model::{Advice, Model, classify, normals};
pub use rows::{Reciprocals, RowError, RowModel, Rows, Seen, Wanted, row};
pub use solve::solve;
pub use sums::Rig;
pub use terms::{Order, TERMS};
