//! The page of an MBS run that is compared with nothing: whole without FE, and without a word of it.

use super::{between, collapse, head, no_level_of_headings_is_left_out};
use fallwerk::report::*;

/// The made-up collapse without its FE side.
fn alone() -> ReportInput {
    let full = collapse::report(0.8, 5);
    let mut scene = full.scene.unwrap();
    scene.fe = None;
    let mut partition = full.partition.unwrap();
    (partition.fe_share, partition.fe_never_share, partition.hybrid_share) = Default::default();
    partition.moments.iter_mut().for_each(|m| m.pictures.retain(|p| p.run == "MBS"));
    let of_mbs =
        |h: History| History { point: h.point, time_s: h.time_s, mbs_m: h.mbs_m, ..History::default() };
    let site = |s: HingeSite| HingeSite {
        fe_zone: None,
        fe_first_s: None,
        fe_peak_strain_rate_1_s: None,
        fe_max_plastic_strain: None,
        mbs_hinge: true,
        ..s
    };
    ReportInput {
        title: "Run of the generated multibody model".into(),
        building_name: full.building_name,
        mbs_alone: true,
        verdict: Verdict {
            headline: "The structure collapses in the MBS run".into(),
            detail: "Not compared with FE.".into(),
            ..Verdict::default()
        },
        first_contact: FirstContact { fe_s: None, ..full.first_contact },
        histories: full.histories.into_iter().map(of_mbs).collect(),
        hinge_sites: full.hinge_sites.into_iter().map(site).collect(),
        counted_rotation_rad: Some(0.02),
        mbs_energy: full.mbs_energy.map(|e| MbsEnergy { error: Some(0.0076), ..e }),
        mbs_run: full.mbs_run,
        model: full.model,
        curves: full.curves,
        events: full.events.into_iter().filter(|e| e.run == "MBS").collect(),
        scene: Some(scene),
        partition: Some(partition),
        debris: Some(DebrisPlan {
            building_m: vec![[[0.0, 0.0], [6.0, 5.0]]],
            runs: vec![DebrisOutline {
                run: "MBS".into(),
                class: "mbs".into(),
                outline_m: vec![vec![[-1.0, -4.0], [6.0, -4.0], [6.0, 5.0], [-1.0, 5.0]]],
                area_m2: 63.0,
                top_m: 2.5,
                ..DebrisOutline::default()
            }],
            ..DebrisPlan::default()
        }),
        ..ReportInput::default()
    }
}

/// What a reader sees below the head of the page.
fn body(page: &str) -> &str {
    between(page, "<main>", "id=\"scene-head\"")
}

#[test]
fn the_page_of_the_mbs_alone_is_whole() {
    let page = render(&alone()).unwrap();
    for text in [
        "<title>Three-storey frame: Run of the generated multibody model</title>",
        "<h1>Run of the generated multibody model</h1>",
        "Not compared with FE.",
        "<dt>First ground contact</dt><dd><b>1.668</b> <span class=\"unit\">s</span>",
        "<dt>Largest displacement</dt>",
        "<dt>Area covered at the end</dt><dd><b>63</b>",
        "<dt>Energy error</dt><dd><b>0.76</b>",
        "<h2>The collapse in 3D</h2>",
        "<h2>Motion</h2>",
        "largest displacement of all points",
        "The other 3 points",
        "<th scope=\"col\">Hinge</th>",
        "MBS: the largest residual is 0.76 % of the energy turned over.",
        "<td>CPU time</td><td class=\"num\">840 ms</td></tr>",
        "first ground contact, S1",
    ] {
        assert!(page.contains(text), "{text}");
    }
    assert_eq!(page.matches("class=\"line mbs\" data-label=\"MBS\"").count(), 12, "four points, three axes");
    assert_eq!(page.matches("<figure class=\"picture\">").count(), 2, "one run at two times");
    no_level_of_headings_is_left_out(&page);
    let head = head(&page);
    assert!(head["fe"].is_null() && head["mbs"]["bodies"].as_array().unwrap().len() == 15);
    let markers = head["markers"].as_array().unwrap();
    assert!(!markers.is_empty() && markers.iter().all(|m| m["fe"] == false && m["node"].is_null()));
}

#[test]
fn the_page_of_the_mbs_alone_has_no_place_for_fe() {
    let page = render(&alone()).unwrap();
    let body = body(&page);
    for word in [
        "FE",
        "hybrid",
        "overlay",
        "Layout",
        "strain",
        "Checks",
        "id=\"runs\"",
        "id=\"checks\"",
        "Rigid share",
        "error",
        "Not recorded",
        "class=\"empty\"",
        "class=\"line fe\"",
        "MBS only",
        "<th scope=\"col\">Run</th>",
    ] {
        assert!(!body.contains(word), "{word}");
    }
    assert!(page.contains("!fe && m.fe === null ? \"\""), "nor has what the view says of a hinge");
    assert!(!body.contains(">Remark</th>"), "nothing is latent here, and no charge takes a hinge away");
    let with_fe = render(&collapse::report(0.8, 5)).unwrap();
    assert!(with_fe.contains("overlay"));
}

#[test]
fn hinges_are_told_with_what_became_of_them() {
    let mut input = alone();
    let sites = &mut input.hinge_sites;
    sites.truncate(4);
    for s in sites.iter_mut() {
        (s.mbs_yielded_s, s.mbs_fractured_s) = (None, None);
    }
    (sites[0].mbs_yielded_s, sites[0].mbs_fractured_s) = (Some(0.5), Some(1.25));
    sites[1].mbs_slight_s = Some(0.75);
    (sites[2].mbs_latent, sites[2].mbs_live_s) = (true, Some(1.5));
    sites[3].removed_s = Some(0.0);
    let page = render(&input).unwrap();
    for text in [
        "1 of 4 hinges yield by more than 0.020 rad, 1 by less; 1 separates.",
        "<dt>Hinges that yield</dt><dd><b>1 of 4</b><small>1 separate</small>",
        "0.750 (slightly)",
        "<td>latent until 1.500 s</td>",
        "<td>taken away by a charge at 0.000 s</td>",
    ] {
        assert!(page.contains(text), "{text}");
    }
}

/// A building that stands does not collapse in a heading either.
#[test]
fn what_stands_is_not_headed_as_a_collapse() {
    let page = render(&ReportInput { stands: true, ..alone() }).unwrap();
    let body = body(&page);
    assert!(body.contains("<h2>The run in 3D</h2>") && body.contains("<h2>The run in pictures</h2>"));
    assert!(!body.contains("ollapse"));
    let compared = render(&ReportInput { stands: true, ..collapse::report(0.8, 5) }).unwrap();
    assert!(compared.contains("<h2>Both runs in 3D</h2>") && !compared.contains("ollapses in 3D"));
}

/// What is left of rounding is no figure.
#[test]
fn a_building_at_rest_has_no_noise_for_figures() {
    let mut input = alone();
    input.histories.iter_mut().flat_map(|h| &mut h.mbs_m).for_each(|u| *u = [0.0, 0.0, -8.88e-16]);
    let page = render(&input).unwrap();
    assert!(
        page.contains("<dt>Largest displacement</dt><dd><b>&lt; 0.001</b> <span class=\"unit\">mm</span>")
    );
    assert!(!page.contains("0.000000000<"), "ticks have digits");
    assert!(page.contains("<td class=\"num\">0.000000</td>"));
}

/// A building that stands, of which nothing was tracked, with a model without hinges.
#[test]
fn a_page_of_little_is_a_page() {
    let page = render(&ReportInput { mbs_alone: true, ..ReportInput::default() }).unwrap();
    assert!(page.contains("<dt>First ground contact</dt><dd><b>none</b>"));
    assert!(page.contains("No points were tracked.") && page.contains("The model has no hinges."));
    assert!(!page.contains("scene-data\">"));
    let mut input = alone();
    input.histories[0].mbs_m.pop();
    assert!(matches!(render(&input), Err(ReportError::Length { .. })));
}
