//! Oracles, scenes and loaders that the tests share.
