//! Faces of the cone of colors. Three lights make colors that fill a cone; where one of them is shaded, the color is a sum
//! of the other two and lies in a face of that cone.

use super::window::Window;

/// At most one for each light.
pub const MAX_FACES: usize = 3;

/// A face: colors for which `normal . rho` is below `least` are shaded.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Face {
    /// Of unit length; zero for none.
    pub normal: [f32; 3],
    /// In pixel values.
    pub least: f32,
}

impl Face {
    const fn is_there(&self) -> bool {
        let [x, y, z] = self.normal;
        x != 0.0 || y != 0.0 || z != 0.0
    }

    pub(crate) fn lit(&self, window: &Window) -> u64 {
        window.bits(|r, g, b| distance(self.normal, [r, g, b]) >= self.least)
    }
}

/// The faces of the cone, as many as there are shadows of different lights.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Faces {
    /// Faces that are not there are zero: every color is above them.
    pub faces: [Face; MAX_FACES],
}

impl Faces {
    /// No shadows.
    pub const NONE: Self = Self { faces: [Face { normal: [0.0; 3], least: 0.0 }; MAX_FACES] };

    /// Which of the window's colors `among` these all three lights reach.
    #[must_use]
    pub fn lit(&self, window: &Window, among: u64) -> u64 {
        let mut lit = among;
        for face in &self.faces {
            if face.is_there() && lit != 0 {
                lit &= face.lit(window);
            }
        }
        lit
    }

    pub(crate) fn is_lit(&self, color: [f32; 3]) -> bool {
        self.faces.iter().all(|face| distance(face.normal, color) >= face.least)
    }
}

/// How far a color lies from the plane through black with this unit normal, in pixel values.
pub(crate) fn distance([x, y, z]: [f32; 3], [r, g, b]: [f32; 3]) -> f32 {
    x * r + y * g + z * b
}
