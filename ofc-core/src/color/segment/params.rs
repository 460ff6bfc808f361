//! How to segment.

/// Room for regions.
pub const MAX_REGIONS: usize = 16;

/// How to segment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Params {
    /// The largest |rho^T C rho - 1| within a region, in (0, 1). Default 0.1: colors within 5 % of the ellipsoid.
    pub tolerance: f64,
    /// Smaller regions are dropped, pixels, at least 12. Default 200.
    pub min_pixels: u32,
    /// At most this many regions, 1 to [`MAX_REGIONS`]. Default 8.
    pub max_regions: u32,
    /// Blocks of six pixels that are tried for each region, at least 1 and at most 1,000,000. Default 300.
    pub blocks: u32,
    /// The distance between the pixels of a block, 0 to 64, or 0 for 1, 2, 4, 8 and 16 in turn; 1 is \[14\]. Default 0.
    pub spacing: u32,
    /// How far around a block its C is tried, in pixels, 1 to 1000. Default 24.
    pub reach: u32,
    /// Times that a region is fitted and grown again, at most 100. Default 12; 0 is \[14\].
    pub refits: u32,
    /// Fixes every random choice. Default 0.
    pub seed: u64,
}

impl Default for Params {
    fn default() -> Self {
        Self {
            tolerance: 0.1,
            min_pixels: 200,
            max_regions: 8,
            blocks: 300,
            spacing: 0,
            reach: 24,
            refits: 12,
            seed: 0,
        }
    }
}

impl Params {
    /// Whether every parameter is in its range.
    #[must_use]
    pub fn are_valid(&self) -> bool {
        self.tolerance > 0.0
            && self.tolerance < 1.0
            && self.min_pixels >= 12
            && (1..=MAX_REGIONS as u32).contains(&self.max_regions)
            && (1..=1_000_000).contains(&self.blocks)
            && self.spacing <= 64
            && (1..=1000).contains(&self.reach)
            && self.refits <= 100
    }
}
