//! The report page as a whole: self-contained, escaped, complete, and its 3D data true to the input.

mod alone;
mod collapse;

use fallwerk::report::*;
use serde_json::Value;

/// The text between two markers.
fn between<'a>(page: &'a str, from: &str, to: &str) -> &'a str {
    let start = page.find(from).unwrap_or_else(|| panic!("no {from}")) + from.len();
    &page[start..start + page[start..].find(to).unwrap_or_else(|| panic!("no {to}"))]
}

fn head(page: &str) -> Value {
    serde_json::from_str(between(page, "id=\"scene-head\">", "</script>")).unwrap()
}

/// The bytes of the scene, by a decoder of its own.
fn bytes(page: &str) -> Vec<u8> {
    let text = between(page, "id=\"scene-data\">", "</script>").trim();
    let digit = |c: u8| match c {
        b'A'..=b'Z' => c - b'A',
        b'a'..=b'z' => c - b'a' + 26,
        b'0'..=b'9' => c - b'0' + 52,
        b'+' => 62,
        b'/' => 63,
        _ => panic!("not base64: {c}"),
    };
    let mut out = Vec::new();
    let (mut word, mut bits) = (0_u32, 0);
    for c in text.bytes().filter(|&c| c != b'=') {
        word = word << 6 | u32::from(digit(c));
        bits += 6;
        if bits >= 8 {
            bits -= 8;
            out.push((word >> bits) as u8);
            word &= (1 << bits) - 1;
        }
    }
    out
}

fn block<'a>(data: &'a [u8], place: &Value) -> &'a [u8] {
    let at = |i: usize| place[i].as_u64().unwrap() as usize;
    &data[at(0)..at(0) + at(1)]
}

/// Positions `[node][axis][frame]` as the viewer reads them.
fn positions(page: &str) -> Vec<[Vec<f64>; 3]> {
    let (head, data) = (head(page), bytes(page));
    let fe = &head["fe"];
    let mut stream = block(&data, &fe["positions"]).iter();
    let mut next = || {
        let (mut value, mut shift) = (0_u32, 0);
        loop {
            let b = *stream.next().unwrap();
            value |= u32::from(b & 127) << shift;
            shift += 7;
            if b < 128 {
                return (value >> 1) as i32 ^ -((value & 1) as i32);
            }
        }
    };
    let frames = head["times"].as_array().unwrap().len();
    let nodes = fe["nodes"].as_u64().unwrap() as usize;
    let read = (0..nodes)
        .map(|_| {
            [0, 1, 2].map(|axis| {
                let number = |key: &str| fe[key][axis].as_f64().unwrap();
                let mut q: Vec<i32> = Vec::new();
                for f in 0..frames {
                    let guess = if f < 2 { q.last().copied().unwrap_or(0) } else { 2 * q[f - 1] - q[f - 2] };
                    q.push(guess + next());
                }
                q.iter().map(|&q| number("origin") + f64::from(q) * number("step")).collect()
            })
        })
        .collect();
    assert!(stream.next().is_none(), "bytes left over");
    read
}

#[test]
fn the_page_of_a_full_scene_is_small_and_can_be_kept_for_looking_at() {
    let input = collapse::report(0.34, 251);
    let page = render(&input).unwrap();
    let nodes = head(&page)["fe"]["nodes"].as_u64().unwrap();
    eprintln!("{nodes} nodes x 251 frames: {:.2} MB", page.len() as f64 / 1e6);
    assert!((3200..4200).contains(&nodes), "{nodes}");
    assert!(page.len() < 6_000_000, "{}", page.len());
    if let Some(path) = std::env::var_os("FALLWERK_REPORT_OUT") {
        std::fs::write(path, &page).unwrap();
    }
}

/// Who hears the page goes from heading to heading: none is two steps below the one before.
fn no_level_of_headings_is_left_out(page: &str) {
    let levels =
        page.split("<h").skip(1).filter_map(|h| h.chars().next()?.to_digit(10)).collect::<Vec<u32>>();
    assert!(levels.len() > 5 && levels.windows(2).all(|w| w[1] <= w[0] + 1), "{levels:?}");
}

#[test]
fn no_heading_skips_a_level() {
    no_level_of_headings_is_left_out(&render(&collapse::report(0.8, 5)).unwrap());
}

/// Without scripts there is a sentence in place of the 3D view and its controls.
#[test]
fn without_javascript_no_dead_controls_are_left() {
    let page = render(&collapse::report(0.8, 5)).unwrap();
    let hidden = between(&page, "<noscript><style>", "</style></noscript>");
    for class in [".stage", ".transport", ".options", ".keys", ".hint"] {
        assert!(hidden.contains(class), "{class}");
    }
    assert!(page.contains("The 3D view needs JavaScript."));
    assert!(!render(&ReportInput::default()).unwrap().contains("<noscript>"));
}

/// Browsers leave backgrounds out of what they print, unless a page says that they mean something.
#[test]
fn legends_keep_their_colours_in_print() {
    let page = render(&collapse::report(0.8, 5)).unwrap();
    let print = between(&page, "@media print {", "</style>");
    assert!(print.contains(".swatch, .site, .ramp") && print.contains("print-color-adjust: exact"));
}

#[test]
fn the_page_loads_nothing() {
    let page = render(&collapse::report(0.8, 5)).unwrap();
    assert!(!page.contains("http://") && !page.contains("https://"));
    for load in ["src=", "@import", "url(", "fetch(", "XMLHttpRequest", "<link", "<iframe", "import("] {
        assert!(!page.contains(load), "{load}");
    }
    for target in page.split("href=\"").skip(1) {
        assert!(target.starts_with('#'), "{}", &target[..40]);
    }
}

#[test]
fn names_from_outside_stay_text() {
    const HOSTILE: &str = "</script><img src=x onerror=alert(1)>\" ' & \u{2028}";
    let mut input = collapse::report(0.8, 3);
    let text = || HOSTILE.to_string();
    input.title = text();
    input.building_name = text();
    input.building_description = text();
    input.program_version = text();
    input.verdict.headline = text();
    input.verdict.detail = text();
    input.checks[0] =
        Check { label: text(), value: text(), limit: text(), status: Status::Pass, explanation: text() };
    input.settings = vec![Setting { name: text(), value: text() }];
    input.histories[0].point = text();
    input.hinge_sites[0].member_end = text();
    input.events[0] = TimedEvent { time_s: 0.0, run: text(), what: text() };
    input.compared[0].name = text();
    input.compared_notes = vec![text()];
    let moment = &mut input.partition.as_mut().unwrap().moments[0];
    moment.label = text();
    (moment.pictures[0].run, moment.pictures[0].words) = (text(), text());
    input.notes = [Severity::Note, Severity::Warning].map(|severity| Note { severity, text: text() }).into();
    input.curves[0].id = text();
    input.curves[0].description = text();
    input.model.bodies[0] = BodyRow { id: text(), mass_kg: 1.0, members: vec![text()] };
    input.model.trace[0] = TraceRow { part: text(), rule: text(), words: text(), entries: vec![text()] };
    let scene = input.scene.as_mut().unwrap();
    scene.obstacles[0].label = text();
    scene.fe.as_mut().unwrap().parts[0] = ScenePart { id: text(), group: text() };
    scene.mbs.as_mut().unwrap().bodies[0].id = text();
    let page = render(&input).unwrap();
    assert!(!page.contains("<img"));
    assert_eq!(page.matches("</script>").count(), 4, "head, data, charts, viewer");
    assert_eq!(head(&page)["markers"][0]["label"], HOSTILE);
}

#[test]
fn the_page_shows_the_given_figures() {
    let page = render(&collapse::report(0.8, 5)).unwrap();
    for text in [
        "MBS agrees with FE up to first contact: e = 0.041",
        "3 of 5 checks passed, 1 failed, 1 undecided",
        "FE contact 1.620 s",
        "MBS contact 1.668 s",
        "+48",
        "10.2 min",
        "840 ms",
        "61\u{202f}728",
        "outside the range of its evidence",
        "u\u{2009}z [m]",
        "moment [kN m]",
        "energy [MJ]",
        "C3/1 bottom",
        "N = 250.0 kN",
        "728", // ratio of the CPU times: 612 / 0.84
    ] {
        assert!(page.contains(text), "{text}");
    }
}

#[test]
fn the_page_shows_all_runs() {
    let page = render(&collapse::report(0.8, 5)).unwrap();
    for text in [
        "The runs against FE",
        "0.012",
        "49 %",
        "debris from 1.700 s",
        "hybrid against FE",
        "hybrid without points that become debris",
        "larger values at the start, up to 0.81, are not drawn",
        "before the first contact, t = 0.800 s",
        "Rigid share of the elements",
        "max |Δu| hybrid",
    ] {
        assert!(page.contains(text), "{text}");
    }
    assert_eq!(page.matches("<figure class=\"picture\">").count(), 6, "three runs at two times");
    assert_eq!(
        page.matches("class=\"line hybrid\" data-label=\"hybrid\"").count(),
        12,
        "four points, three axes"
    );
    let mut input = collapse::report(0.8, 5);
    (input.compared, input.partition, input.hybrid_run) = Default::default();
    input.histories.iter_mut().for_each(|h| h.hybrid_m.clear());
    let error = input.error.as_mut().unwrap();
    (error.hybrid, error.without_debris, error.hybrid_without_debris) = Default::default();
    let page = render(&input).unwrap();
    let body = &page[page.find("<body>").unwrap()..page.find("id=\"scene-head\"").unwrap()];
    assert!(!body.contains("hybrid"), "a report of two runs does not speak of a third");
}

/// A structure that stands has a distance of millimetres, and neither debris nor a time after contact.
#[test]
fn what_stands_is_told_by_its_distance() {
    let mut input = collapse::report(0.8, 5);
    input.standing = Some(Standing { apart_m: 2.4e-3, limit_m: 0.05, largest_m: [4e-3, 3.2e-3] });
    input.error.as_mut().unwrap().contact_s = None;
    input.hinge_sites.iter_mut().for_each(|s| (s.fe_zone, s.mbs_yielded_s) = (Some(false), None));
    for h in &mut input.histories {
        h.fe_m.iter_mut().for_each(|u| *u = [1e-9; 3]);
    }
    let page = render(&input).unwrap();
    for text in [
        "<dt>Largest distance of displacements</dt><dd><b>2.4</b> <span class=\"unit\">mm</span><small>FE 4.00 mm, MBS 3.20 mm; limit 50 mm",
        "FE shows no zone of accumulated damage at these sites; no hinge of the MBS yielded so that it counts.",
        "&gt; 1000 %",
    ] {
        assert!(page.contains(text), "{text}");
    }
    for text in ["Error e up to first contact", "FE zones found", "Shaded:", "up to contact [m]", "F1 ="] {
        assert!(!page.contains(text), "{text}");
    }
    input.standing.as_mut().unwrap().apart_m = 2.4e-5;
    assert!(render(&input).unwrap().contains("<b>24</b> <span class=\"unit\">µm</span>"));
}

/// A column has the colour of columns whatever else there is.
#[test]
fn kinds_of_members_keep_their_colours() {
    let colour = |page: &str| head(page)["fe"]["parts"][0][1].as_u64().unwrap();
    let mut input = collapse::report(0.8, 5);
    let page = render(&input).unwrap();
    assert_eq!(colour(&page), 1, "a column");
    assert!(
        page.contains("<i class=\"swatch g1\"></i>column")
            && page.contains("<i class=\"swatch g2\"></i>slab")
    );
    let fe = input.scene.as_mut().unwrap().fe.as_mut().unwrap();
    (fe.parts[1].group, fe.parts[2].group) = ("beam".into(), "arch".into());
    let page = render(&input).unwrap();
    assert_eq!(colour(&page), 1);
    assert!(
        page.contains("<i class=\"swatch g5\"></i>arch") && page.contains("<i class=\"swatch g2\"></i>slab")
    );
}

/// What messages put between backticks is code on the page, and escaped all the same.
#[test]
fn backticks_mark_code() {
    let mut input = collapse::report(0.8, 5);
    input.notes[1].text = "run `fallwerk fe <x>` with `--step` or a ` alone".into();
    let page = render(&input).unwrap();
    assert!(
        page.contains("run <code>fallwerk fe &lt;x&gt;</code> with <code>--step</code> or a ` alone</li>")
    );
}

#[test]
fn charges_and_debris_have_their_plans() {
    let mut input = collapse::report(0.8, 5);
    let without = render(&input).unwrap();
    assert!(!without.contains("id=\"charges\"") && !without.contains("id=\"debris\""));
    let part = PlanPart { kind: PlanKind::Bearing, box_m: [[0.0; 2], [0.4; 2]], charges_s: vec![0.075] };
    input.blasting = Some(BlastingPlan {
        charges: vec![PlannedCharge {
            id: "<front>".into(),
            what: "C1/1 from 0.2 to 1.2 m of its length".into(),
            storey: "1".into(),
            time_s: 0.075,
        }],
        storeys: vec![StoreyPlan { label: "Storey 1".into(), parts: vec![part] }],
    });
    let ring = vec![[-1.0, -4.0], [6.0, -4.0], [6.0, 5.0], [-1.0, 5.0]];
    let outline = |run: &str| DebrisOutline {
        run: run.into(),
        class: run.to_lowercase(),
        outline_m: vec![ring.clone()],
        area_m2: 63.0,
        reach_m: [1.0, 0.0, 4.0, 0.0],
        top_m: 2.5,
        speed_m_s: (run == "MBS").then_some(3.04),
    };
    input.debris = Some(DebrisPlan {
        building_m: vec![[[0.0, 0.0], [6.0, 5.0]]],
        obstacles_m: vec![[[-1.0, -7.6], [4.0, -7.2]]],
        runs: ["FE", "MBS"].map(outline).into(),
    });
    let page = render(&input).unwrap();
    let legend = between(&page, "id=\"debris\"", "</ul>");
    assert!(legend.contains("obstacle") && page.contains(".plan .line.mbs { fill: var(--mbs); }"));
    for text in [
        "&lt;front&gt;",
        ">75</text>",
        "from 0.2 to 1.2 m of its length",
        "63.0",
        ">4.0<",
        "href=\"#debris\"",
        "Not at rest: MBS still moves at 3.0 m&#x2f;s; what",
    ] {
        assert!(page.contains(text), "{text}");
    }
}

/// A charge is carried by what it takes away, in both runs.
#[test]
fn charges_are_marked_where_they_are() {
    let page = render(&collapse::report(0.8, 5)).unwrap();
    let head = head(&page);
    let charge = &head["charges"][1];
    assert_eq!((&charge["label"], &charge["time"]), (&Value::from("front-C2/1"), &Value::from(0.0)));
    let body = charge["body"].as_u64().unwrap() as usize;
    assert_eq!(head["mbs"]["bodies"][body]["id"], "C2/1", "the body that the charge removes");
    assert!(charge["node"].is_u64() && page.contains("charge, until it fires"));
}

/// Footings that are held are no bodies of the model; without them columns would hang above the ground.
#[test]
fn what_the_building_stands_on_is_drawn_with_the_bodies() {
    let mut input = collapse::report(0.8, 5);
    let page = render(&input).unwrap();
    let half: Vec<f64> = serde_json::from_value(head(&page)["mbs"]["fixed"][0]["half"].clone()).unwrap();
    assert!(half.iter().zip([0.6, 0.6, 0.3]).all(|(a, b)| (a - b).abs() < 1e-9), "{half:?}");
    assert!(page.contains("obstacle; MBS: held, no body"));
    input.scene.as_mut().unwrap().mbs.as_mut().unwrap().fixed.clear();
    assert!(!render(&input).unwrap().contains("MBS: held, no body"));
}

/// Legends name obstacles where there are some.
#[test]
fn obstacles_are_named_where_there_are_some() {
    let mut input = collapse::report(0.8, 5);
    let keys = |page: &str| {
        ["key-part", "partition"]
            .map(|id| between(page, &format!("id=\"{id}\""), "</ul>").contains("obstacle"))
    };
    assert_eq!(keys(&render(&input).unwrap()), [true, false], "the wall is not in the pictures");
    let facets = &mut input.partition.as_mut().unwrap().moments[0].pictures[0].facets;
    facets.push(Facet { kind: FacetKind::Obstacle, ..facets[0] });
    input.scene.as_mut().unwrap().obstacles.clear();
    assert_eq!(keys(&render(&input).unwrap()), [false, true]);
}

/// A site that FE has not evaluated is no site without a zone: the 3D view has a mark of its own for it, as the matrix has a line.
#[test]
fn sites_that_fe_has_not_evaluated_are_told_apart() {
    let mut input = collapse::report(0.8, 5);
    let page = render(&input).unwrap();
    assert!(page.contains("</i>FE not evaluated</li>") && page.contains("m.fe === null ? 4"));
    assert_eq!(head(&page)["markers"].as_array().unwrap().iter().filter(|m| m["fe"].is_null()).count(), 1);
    input.hinge_sites.retain(|s| s.fe_zone.is_some());
    assert!(!render(&input).unwrap().contains("</i>FE not evaluated</li>"));
}

#[test]
fn latent_sections_and_compounds_are_shown() {
    let mut input = collapse::report(0.8, 5);
    let site = &mut input.hinge_sites[0];
    (site.mbs_latent, site.mbs_live_s, site.mbs_yielded_s) = (true, Some(1.25), None);
    input.hinge_sites[1].mbs_latent = true;
    let page = render(&input).unwrap();
    assert!(page.contains("<td>latent, live from 1.250 s</td>") && page.contains("<td>latent</td>"));
    assert!(page.contains("class=\"live\" d=\"M"), "marked in the pictures");
    let head = head(&page);
    assert_eq!(head["mbs"]["compounds"], serde_json::json!([13, 13, 15, 15, 15]));
    assert_eq!(head["markers"][0]["live"], 1.25);
    input.scene.as_mut().unwrap().mbs.as_mut().unwrap().compounds.pop();
    assert!(matches!(render(&input), Err(ReportError::Length { .. })));
}

/// A hinge that yields by less than counts is there, and says so; a site whose member a charge took away has no marker from then on.
#[test]
fn slight_hinges_and_removed_sites_are_told() {
    let mut input = collapse::report(0.8, 5);
    let page = render(&input).unwrap();
    assert!(!page[..page.find("id=\"scene-head\"").unwrap()].contains("slightly"));
    assert_eq!(head(&page)["markers"][0]["gone"], Value::Null);
    let site = &mut input.hinge_sites[0];
    (site.mbs_yielded_s, site.mbs_slight_s, site.removed_s) = (None, Some(1.25), Some(0.5));
    input.counted_rotation_rad = Some(0.02);
    let page = render(&input).unwrap();
    for text in [
        "1.250 (slightly)",
        "FE, MBS slightly",
        "1 hinge of the MBS yields slightly, by less than 0.020 rad, and does not count.",
    ] {
        assert!(page.contains(text), "{text}");
    }
    let marker = &head(&page)["markers"][0];
    assert_eq!((&marker["gone"], &marker["slight"]), (&Value::from(0.5), &Value::from(1.25)));
    assert!(page.contains("(slightly)`"), "the marker says it too");
}

/// The page has one energy error of a run, that of the checks.
#[test]
fn the_energy_error_is_over_the_energy_turned_over() {
    let page = render(&collapse::report(0.8, 5)).unwrap();
    assert!(page.contains("FE: the largest residual is 0.40 % of the energy turned over"));
    assert!(!page.contains("MBS: the largest residual") && !page.contains("of the largest energy"));
}

#[test]
fn what_was_left_out_is_a_table_if_anything_was() {
    let mut input = collapse::report(0.8, 5);
    assert!(!render(&input).unwrap().contains("What was left out"));
    let row = LeftOutRow {
        run: "MBS".into(),
        what: "pairs".into(),
        left_out: 379_319,
        of: 399_923,
        unit: "pairs × steps".into(),
        computed_by: Some("simulate --compute-all".into()),
    };
    input.left_out = vec![row.clone(), LeftOutRow { of: 0, left_out: 0, computed_by: None, ..row }];
    let page = render(&input).unwrap();
    for text in ["94.85 %", "379\u{202f}319", "399\u{202f}923 pairs × steps", "simulate --compute-all", "– %"]
    {
        assert!(page.contains(text), "{text}");
    }
}

#[test]
fn positions_come_back_within_half_a_quantisation_step() {
    let mut input = collapse::report(0.8, 21);
    let fe = input.scene.as_mut().unwrap().fe.as_mut().unwrap();
    fe.elements.iter_mut().for_each(|e| e.death_s = None); // every node is needed to the end
    let page = render(&input).unwrap();
    let fe = input.scene.as_ref().unwrap().fe.as_ref().unwrap();
    let mut used: Vec<u32> = fe.faces.iter().flat_map(|f| f.nodes).collect();
    used.sort_unstable();
    used.dedup();
    let read = positions(&page);
    assert_eq!(read.len(), used.len());
    let head = head(&page);
    for (track, &node) in read.iter().zip(&used) {
        for axis in 0..3 {
            let step = head["fe"]["step"][axis].as_f64().unwrap();
            assert!(step < 0.5e-3, "{step}");
            for (frame, &x) in track[axis].iter().enumerate() {
                let given = f64::from(fe.frames_m[frame][node as usize][axis]);
                assert!(
                    (x - given).abs() <= 0.5 * step * (1.0 + 1e-6),
                    "node {node} axis {axis} frame {frame}"
                );
            }
        }
    }
}

#[test]
fn an_eroded_fragment_flying_off_does_not_coarsen_the_rest() {
    let mut input = collapse::report(0.8, 21);
    let plain = head(&render(&input).unwrap())["fe"]["step"][2].as_f64().unwrap();
    let fe = input.scene.as_mut().unwrap().fe.as_mut().unwrap();
    fe.elements.iter_mut().for_each(|e| e.death_s = Some(1.0));
    for frame in &mut fe.frames_m[12..] {
        frame.iter_mut().for_each(|p| p[2] = 1e4);
    }
    let flown = head(&render(&input).unwrap())["fe"]["step"][2].as_f64().unwrap();
    assert!(flown <= plain * 1.001, "{flown} > {plain}");
}

#[test]
fn faces_between_elements_are_born_when_the_neighbour_dies() {
    let hexes = [[0, 1, 2, 3, 4, 5, 6, 7], [4, 5, 6, 7, 8, 9, 10, 11]];
    let element = |death_s| SceneElement { part: 0, death_s };
    let alive = faces_of_hexes(&hexes, &[element(None), element(None)]);
    assert_eq!(alive.len(), 10);
    let faces = faces_of_hexes(&hexes, &[element(Some(0.7)), element(None)]);
    assert_eq!(faces.len(), 11);
    let born: Vec<_> = faces.iter().filter(|f| f.birth_s.is_some()).collect();
    assert_eq!((born.len(), born[0].element, born[0].birth_s), (1, 1, Some(0.7)));
    let together = faces_of_hexes(&hexes, &[element(Some(0.7)), element(Some(0.7))]);
    assert_eq!(together.len(), 10);
}

#[test]
fn gaps_in_histories_and_poses_do_not_break_the_page() {
    let mut input = collapse::report(0.8, 5);
    input.histories[0].mbs_m[100..140].iter_mut().for_each(|u| *u = [f64::NAN; 3]);
    input.error.as_mut().unwrap().e[0] = f64::NAN;
    input.error.as_mut().unwrap().until_end = Some(f64::NAN);
    input.fe_energy.as_mut().unwrap().residual_j[3] = f64::INFINITY;
    let scene = input.scene.as_mut().unwrap();
    scene.fe.as_mut().unwrap().frames_m[3][0] = [f32::NAN; 3];
    scene.mbs.as_mut().unwrap().frames[2][0].position_m[1] = f64::NAN;
    let page = render(&input).unwrap();
    let body = &page[..page.find("id=\"scene-head\"").unwrap()];
    assert!(!body.contains("NaN") && !body.contains("inf\"") && !body.contains("inf "));
    assert!(positions(&page).iter().flatten().flatten().all(|x| x.is_finite()));
    // The gap: the MBS line of the first point has two stretches.
    let broken = body.split("class=\"line mbs\" data-label=\"MBS\" d=\"").skip(1);
    assert_eq!(broken.filter(|d| d.split('"').next().unwrap().matches('M').count() == 2).count(), 3);
}

#[test]
fn an_empty_report_is_a_page() {
    let page = render(&ReportInput::default()).unwrap();
    assert!(page.contains("No verdict was given.") && page.contains("No hinge sites were compared."));
    assert!(!page.contains("scene-data\">"));
    let scene =
        Some(Scene { fe: Some(FeScene::default()), mbs: Some(MbsScene::default()), ..Scene::default() });
    let page = render(&ReportInput { scene, ..ReportInput::default() }).unwrap();
    assert_eq!(head(&page)["fe"]["nodes"], 0);
}

#[test]
fn lists_that_do_not_fit_are_refused() {
    let mut input = collapse::report(0.8, 5);
    input.histories[0].fe_m.pop();
    assert!(matches!(render(&input), Err(ReportError::Length { .. })));
    let mut input = collapse::report(0.8, 5);
    input.scene.as_mut().unwrap().fe.as_mut().unwrap().faces[0].nodes[2] = u32::MAX;
    assert!(matches!(render(&input), Err(ReportError::Index { .. })));
    let mut input = collapse::report(0.8, 5);
    input.scene.as_mut().unwrap().time_s[1] = -1.0;
    assert!(matches!(render(&input), Err(ReportError::Times { .. })));
}

#[test]
fn the_same_input_gives_the_same_bytes() {
    assert!(render(&collapse::report(0.6, 9)).unwrap() == render(&collapse::report(0.6, 9)).unwrap());
}
