//! Every error of the core says what is wrong, as `core::error::Error`.

use ofc_core::check::CheckError;
use ofc_core::color::ellipsoid::NotPositiveDefinite;
use ofc_core::color::lmeds::FitError;
use ofc_core::color::offset::OffsetError;
use ofc_core::color::rank::patches::Refused;
use ofc_core::color::segment::SegmentError;
use ofc_core::math::arena::Need;
use ofc_core::orientation::orthogonal::OrthogonalError;
use ofc_core::orientation::relief::ReliefError;
use ofc_core::picture::ImageError;
use ofc_core::picture::dark::DarkError;
use ofc_core::picture::flat_field::FlatFieldError;
use ofc_core::picture::transfer::TransferError;
use ofc_core::render::{DepthMapError, LightsError, RenderError};
use ofc_core::rig::{FileError, RowError};
use ofc_core::stream::StreamError;
use ofc_core::surface::completion::CompletionError;
use ofc_core::surface::depth::DepthError;
use ofc_core::surface::normals::TooShort;
use std::error::Error;
use std::path::Path;

#[test]
fn every_error_says_what_is_wrong() {
    let color_deviations = [0.0; 3];
    let errors: [Box<dyn Error>; 87] = [
        Box::new(CheckError::Orientation),
        Box::new(CheckError::WorkspaceTooShort),
        Box::new(CheckError::NoInliers),
        Box::new(CheckError::Size),
        Box::new(NotPositiveDefinite { eigenvalues: [1.0, 1.0, -1.0] }),
        Box::new(FitError::Params),
        Box::new(FitError::WorkspaceTooShort),
        Box::new(FitError::TooFewPixels),
        Box::new(FitError::Dark),
        Box::new(FitError::Saturated),
        Box::new(FitError::RankDeficient { color_deviations }),
        Box::new(SegmentError::Params),
        Box::new(SegmentError::LabelsTooShort),
        Box::new(SegmentError::WorkspaceTooShort),
        Box::new(Refused),
        Box::new(OrthogonalError::Params),
        Box::new(OrthogonalError::WorkspaceTooShort),
        Box::new(OrthogonalError::SingularRoot),
        Box::new(OrthogonalError::NoCells),
        Box::new(ImageError::Empty),
        Box::new(ImageError::TooLarge),
        Box::new(ImageError::StrideTooSmall),
        Box::new(ImageError::TooShort),
        Box::new(ReliefError::Params),
        Box::new(ReliefError::Size),
        Box::new(ReliefError::TooSmall),
        Box::new(ReliefError::Workspace(Need::of_singles(1))),
        Box::new(ReliefError::TooFewPixels),
        Box::new(ReliefError::NothingTouched),
        Box::new(ReliefError::NoMajority),
        Box::new(ReliefError::NotDetermined),
        Box::new(ReliefError::NotIntegrable),
        Box::new(ReliefError::HasEdge),
        Box::new(TransferError::Exponent),
        Box::new(TransferError::Length),
        Box::new(TransferError::Entry),
        Box::new(TransferError::Output(ImageError::StrideTooSmall)),
        Box::new(DarkError::Frame),
        Box::new(DarkError::Offset),
        Box::new(DarkError::Output(ImageError::TooLarge)),
        Box::new(OffsetError::Form),
        Box::new(OffsetError::WorkspaceTooShort),
        Box::new(OffsetError::TooFewPixels),
        Box::new(OffsetError::NotDetermined),
        Box::new(FileError::Kind),
        Box::new(FileError::Version),
        Box::new(FileError::Size),
        Box::new(FileError::Damaged),
        Box::new(FileError::Numbers),
        Box::new(RowError::Row),
        Box::new(RowError::TooMany),
        Box::new(FlatFieldError::Size),
        Box::new(FlatFieldError::Output),
        Box::new(FlatFieldError::Background),
        Box::new(DepthMapError::Image(ImageError::Empty)),
        Box::new(DepthMapError::Pitch),
        Box::new(LightsError::Count),
        Box::new(LightsError::Size),
        Box::new(LightsError::Direction),
        Box::new(LightsError::Color),
        Box::new(RenderError::NonFiniteDepth),
        Box::new(RenderError::Peak),
        Box::new(RenderError::Noise),
        Box::new(RenderError::Size),
        Box::new(StreamError::Params),
        Box::new(StreamError::Size),
        Box::new(StreamError::TooShort),
        Box::new(StreamError::NoFrame),
        Box::new(StreamError::NotSolved),
        Box::new(StreamError::RowOrder),
        Box::new(StreamError::TooManyRows),
        Box::new(StreamError::TooFewRows),
        Box::new(StreamError::Row),
        Box::new(StreamError::Fit(FitError::Dark)),
        Box::new(DepthError::Size),
        Box::new(DepthError::Parameter),
        Box::new(DepthError::Workspace(Need::of_singles(7))),
        Box::new(DepthError::Output),
        Box::new(DepthError::Empty),
        Box::new(CompletionError::Size),
        Box::new(CompletionError::Parameter),
        Box::new(CompletionError::Workspace(Need::of_singles(7))),
        Box::new(CompletionError::Output),
        Box::new(CompletionError::Empty),
        Box::new(CompletionError::OtherPicture),
        Box::new(TooShort),
        Box::new(StreamError::Fit(FitError::RankDeficient { color_deviations })),
    ];
    for error in &errors {
        let text = error.to_string();
        // As the standard library's: one phrase, to be put after a colon.
        assert!(text.len() > 15 && !text.ends_with('.'), "{text}");
    }
    assert_eq!(FitError::Dark.to_string(), "fewer than 12 usable pixels: most are black");
    assert_eq!(StreamError::Fit(FitError::Dark).to_string(), FitError::Dark.to_string());
    assert_eq!(
        DepthError::Workspace(Need::of_singles(7)).to_string(),
        "the workspace holds less than 28 bytes"
    );
}

/// Public types that functions return as errors and that do not implement `Error` in their own file.
fn without_impl(folder: &Path, found: &mut (Vec<String>, usize)) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            without_impl(&path, found);
            continue;
        }
        let text = std::fs::read_to_string(&path).unwrap();
        for line in text.lines().filter(|line| line.starts_with("pub enum ")) {
            let name = line.split(' ').nth(2).unwrap();
            if name.ends_with("Error") {
                found.1 += 1;
                if !text.contains(&format!("impl core::error::Error for {name} {{")) {
                    found.0.push(name.into());
                }
            }
        }
    }
}

#[test]
fn no_error_of_the_core_is_left_out() {
    let mut found = (Vec::new(), 0);
    without_impl(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../ofc-core/src"), &mut found);
    assert!(found.0.is_empty(), "{:?}", found.0);
    assert!(found.1 >= 11, "{} errors", found.1);
}
