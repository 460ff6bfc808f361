//! What lights and surface a patch of colors can be of: Petrov and Kontsevich's classification.
//!
//! Colors are rho = F n, so a patch has colors of three dimensions only where the light and the surface both have rank 3: where F
//! is of rank 3, and the normals span space. A cylinder or another surface that bends in one direction has rank 2, a plane rank 1;
//! lights in one plane, or of two colors, have rank 2, and one light, or lights of one color, rank 1. The colors of a patch say
//!
//! | colors of the patch | light | surface |
//! | --- | --- | --- |
//! | three dimensions | 3 | 3 |
//! | two dimensions, filling a part of their plane | 2 | 3 |
//! | two dimensions, on a conic: the normals lie in a plane | - | 2 |
//! | one dimension, of varying brightness | 1 | - |
//! | one color: the normals are all the same | - | 1 |
//!
//! and what they do not say is 0 in the class. A patch shares its lights with the region around it, which may say what the patch
//! does not: see [`Class::under`]. Whatever the lights are, no patch says whether a surface in the light of one lamp has rank 2 or 3.
//!
//! # Reference
//! Section 1.2. \[13\]: A. P. Petrov, L. L. Kontsevich, "Properties of color images of surfaces under multiple illuminants",
//! J. Opt. Soc. Am. A 11, 1994.

/// Rank of the light and rank of the surface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Class {
    /// The rank of the light, 1 to 3; 0 where the colors do not say.
    pub light: u8,
    /// The rank of the surface, which is how many dimensions its normals span, 1 to 3; 0 where the colors do not say.
    pub surface: u8,
}

impl Class {
    /// What colors of so many dimensions say, `normals` being how many dimensions their normals span where that is known.
    pub(super) const fn of(colors: u32, normals: Option<u32>) -> Self {
        let (light, surface) = match (colors, normals) {
            (3, Some(2)) => (3, 2),
            (3, Some(1)) => (3, 1),
            (3, _) => (3, 3),
            (2, Some(3)) => (2, 3),
            (2, Some(_)) => (0, 2),
            (1, None) => (1, 0),
            (1, Some(_)) => (0, 1),
            _ => (0, 0),
        };
        Self { light, surface }
    }

    /// The class of a patch in a region whose light has rank `light`, 1 to 3: that fills in what the patch does not say. A patch that
    /// says another rank keeps it: it may lie in the shadow of a lamp.
    #[must_use]
    pub const fn under(self, light: u8) -> Self {
        let is_known = self.light > 0 || self.surface == 0;
        Self { light: if is_known { self.light } else { light }, ..self }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_colors_do_not_say_is_zero() {
        let of = |colors, normals| {
            let Class { light, surface } = Class::of(colors, normals);
            (light, surface)
        };
        assert_eq!((of(3, Some(3)), of(3, None), of(2, Some(3))), ((3, 3), (3, 3), (2, 3)));
        assert_eq!((of(2, Some(2)), of(2, None)), ((0, 2), (0, 0)));
        assert_eq!((of(1, Some(1)), of(1, None)), ((0, 1), (1, 0)));
    }

    #[test]
    fn the_region_fills_in_the_light() {
        let class = |light, surface| Class { light, surface };
        assert_eq!(class(0, 2).under(3), class(3, 2));
        assert_eq!(class(0, 1).under(2), class(2, 1));
        assert_eq!(class(2, 3).under(3), class(2, 3));
        assert_eq!(class(1, 0).under(3), class(1, 0));
        // Too few pixels: no class.
        assert_eq!(class(0, 0).under(3), class(0, 0));
    }
}
