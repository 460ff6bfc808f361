//! The table of reasons: random scenes for each, and how many of them are told right.

use ofc_core::color::lmeds;
use ofc_core::solve::{Finding, Outcome, Params, Reason, Solution, reason, solve, workspace_len};
use ofc_tests::reason_scenes::{Draw, Scene};
use std::collections::BTreeMap;

/// What draws a scene of a kind.
type Kind = (&'static str, Reason, fn(&mut Draw) -> Scene);

/// A scene for every reason, and good ones.
const KINDS: [Kind; 18] = [
    ("good", Reason::None, Draw::good),
    ("no pixel in the mask", Reason::MaskEmpty, Draw::masked_away),
    ("inverted mask", Reason::MaskInverted, Draw::inverted_mask),
    ("tiny", Reason::TooFewPixels, Draw::tiny),
    ("not finite", Reason::NotFinite, Draw::not_finite),
    ("saturated", Reason::Saturated, Draw::saturated),
    ("dark", Reason::Dark, Draw::dark),
    ("dead channel", Reason::ChannelDead, Draw::dead_channel),
    ("gray", Reason::Gray, Draw::gray),
    ("two lights", Reason::TooFewLights, Draw::two_lights),
    ("coplanar lights", Reason::LightsCoplanar, Draw::coplanar_lights),
    ("vignette", Reason::Vignette, Draw::vignette),
    ("flat", Reason::Flat, Draw::flat),
    ("cylinder", Reason::Cylinder, Draw::cylinder),
    ("convex or hollow", Reason::ConvexOrHollow, Draw::neither_convex_nor_hollow),
    ("two paints", Reason::TwoPaints, Draw::two_paints),
    ("background", Reason::Background, Draw::background),
    ("outliers", Reason::Outliers, Draw::outliers),
];

/// Variants of each kind, whose seeds begin here. Thresholds were chosen with the seeds from 1000 and from 5000 on.
const VARIANTS: u64 = 200;
const FIRST_SEED: u64 = 20_000;

/// What is found of a scene, and the solution if there is one.
fn found(scene: &Scene) -> (Finding, Option<Solution>) {
    let image = scene.image();
    // Enough for pictures this small.
    let lmeds = lmeds::Params { sample_size: 1500, ..lmeds::Params::default() };
    let params = Params { lmeds, ..Params::default() };
    let mut workspace = vec![0.0; workspace_len(scene.width * scene.height, lmeds.sample_size)];
    match solve(&image, &params, &mut workspace) {
        Ok(solution) => (solution.finding, Some(solution)),
        Err(_) => (reason::of_pixels(&image, &params, &mut workspace).1, None),
    }
}

/// Whether status and reason say nothing else than the ranks in the same solution.
fn agrees(solution: &Solution) -> bool {
    let rank = solution.rank.expect("usable pixels");
    let reason = solution.finding.reason;
    let outcome = match solution.outcome {
        Outcome::RankDeficient => {
            let f = solution.choice.as_ref().map_or(3, |choice| choice.orientation.rank);
            (!rank.is_full() || f < 3) && reason != Reason::None
        }
        Outcome::Undetermined => rank.is_full() && reason != Reason::None,
        Outcome::Solved => {
            let never =
                [Reason::Flat, Reason::Gray, Reason::Vignette, Reason::ChannelDead, Reason::TooFewLights];
            rank.is_full() && !never.contains(&reason)
        }
        _ => reason != Reason::None,
    };
    let ranks = match reason {
        Reason::Flat => (rank.colors, rank.normals) == (1, Some(1)),
        Reason::Gray | Reason::Vignette => (rank.colors, rank.normals) == (1, None),
        Reason::TooFewLights => (rank.colors, rank.normals) == (2, Some(3)),
        Reason::Cylinder if solution.outcome != Outcome::Solved => rank.normals == Some(2),
        _ => true,
    };
    outcome && ranks && (solution.outcome != Outcome::Solved || solution.choice.is_some())
}

/// How often which reason was found of so many variants of a kind; how often about another channel than the right one.
fn row(&(name, reason, draw): &Kind, variants: u64, magnification: usize) -> (BTreeMap<String, u64>, u64) {
    let (mut told, mut other_channel) = (BTreeMap::new(), 0);
    for seed in FIRST_SEED..FIRST_SEED + variants {
        let scene = draw(&mut Draw::new(seed, magnification));
        let (finding, solution) = found(&scene);
        if let Some(solution) = solution {
            assert!(
                agrees(&solution),
                "{name}, seed {seed}: {:?}, {finding:?}, {:?}",
                solution.outcome,
                solution.rank
            );
        }
        assert!(finding.value.is_finite() && finding.limit.is_finite(), "{name}, seed {seed}: {finding:?}");
        if finding.reason == reason && scene.channel.is_some() {
            other_channel += u64::from(finding.channel != scene.channel);
        }
        *told.entry(format!("{:?}", finding.reason)).or_insert(0) += 1;
    }
    (told, other_channel)
}

/// The numbers of `OFC_REASON_*` in a text: where `find` gives the rest of a line that begins with one.
fn numbers<'t>(text: &'t str, find: impl Fn(&'t str) -> Option<&'t str>) -> BTreeMap<&'t str, i32> {
    let lines = text.lines().filter_map(find);
    let entries = lines.map(|line| {
        let mut words =
            line.split(|c: char| !c.is_ascii_alphanumeric() && c != '_').filter(|word| !word.is_empty());
        let name = words.next().expect("a name");
        (
            name,
            words
                .next()
                .and_then(|number| number.parse().ok())
                .unwrap_or_else(|| panic!("{line}: no number")),
        )
    });
    entries.collect()
}

#[test]
fn the_document_has_every_reason_and_its_number() {
    let root = ofc_tests::shipped::root();
    let read = |path| std::fs::read_to_string(root.join(path)).expect("a text");
    let (header, document) = (read("include/ofc.h"), read("docs/reasons.md"));
    let defined =
        numbers(&header, |line| line.strip_prefix("#define ").filter(|rest| rest.starts_with("OFC_REASON_")));
    let documented =
        numbers(&document, |line| line.strip_prefix("| `").filter(|rest| rest.starts_with("OFC_REASON_")));
    assert_eq!(documented, defined);
    // Every reason but the one that names no cause has a scene.
    assert_eq!(defined.len(), KINDS.len() + 1);
    for row in document.lines().filter(|line| line.starts_with("| `OFC_REASON_")) {
        assert_eq!(row.split(" | ").count(), 5, "{row}");
    }
}

/// Of so many variants of every kind, how many are told right, and of how many of these another channel is named.
fn table(variants: u64, magnification: usize) -> Vec<(&'static str, [u64; 2])> {
    let mut rows = Vec::new();
    std::thread::scope(|scope| {
        let row = |kind| scope.spawn(move || row(kind, variants, magnification));
        let threads: Vec<_> = KINDS.iter().map(row).collect();
        rows.extend(threads.into_iter().map(|thread| thread.join().expect("a row of the table")));
    });
    let counts = KINDS.iter().zip(&rows).map(|((name, reason, _), (told, other_channel))| {
        println!("{name:<22} {told:?}, another channel {other_channel}");
        (*name, [told.get(&format!("{reason:?}")).copied().unwrap_or(0), *other_channel])
    });
    counts.collect()
}

#[test]
fn every_reason_is_told_right() {
    let mut wrong = table(VARIANTS, 1);
    wrong.retain(|(_, [right, other_channel])| {
        right * 100 < 95 * VARIANTS || other_channel * 100 > 5 * VARIANTS
    });
    assert!(wrong.is_empty(), "{wrong:?}");
}

#[test]
fn and_of_large_pictures_from_a_sample_of_their_rows() {
    const FEW: u64 = 4;
    // Up to 520 pixels wide and high: every second to fourth row is looked at.
    let told = table(FEW, 5);
    let right: u64 = told.iter().map(|(_, [right, other_channel])| right - other_channel).sum();
    assert!(right * 100 >= 95 * FEW * KINDS.len() as u64, "{told:?}");
}
