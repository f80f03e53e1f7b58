//! A model and its run without FE: the page that shows the collapse at once.

use super::commands::{fallwerk, names, room};
use serde_json::Value;
use std::fs;

#[test]
fn a_run_without_a_comparison_has_its_page() {
    let room = room(str::to_string);
    let (code, out, err) = fallwerk(room.path(), &["generate-mbs", "building.toml", "-o", "run"]);
    assert_eq!(code, 0, "{err}");
    let run = room.path().join("run");
    assert!(out.contains("report     ") && out.contains("report.html"), "{out}");
    assert_eq!(
        names(&run),
        [
            fallwerk::base::output::MARKER,
            "mbs-displacements.csv",
            "mbs-energies.csv",
            "mbs-hinges.csv",
            "mbs.json",
            "model.json",
            "report.html",
            "review.json",
            "trace.json",
        ]
    );
    let read = |name: &str| fs::read_to_string(run.join(name)).unwrap();
    let json = |name: &str| serde_json::from_str::<Value>(&read(name)).unwrap();
    let (page, mbs, model) = (read("report.html"), json("mbs.json"), json("model.json"));
    let count = |value: &Value| value.as_array().unwrap().len();

    let (_, rest) = page.split_once("id=\"scene-head\">").expect("the page has a scene");
    let head: Value = serde_json::from_str(rest.split("</script>").next().unwrap()).unwrap();
    assert!(head["fe"].is_null());
    assert_eq!(count(&head["mbs"]["bodies"]), count(&model["bodies"]));
    assert_eq!(count(&head["times"]), count(&mbs["times_s"]), "all outputs");
    assert_eq!(count(&head["markers"]), count(&mbs["hinges"]), "hinges with a curve");
    assert_eq!(
        page.matches("class=\"line mbs\" data-label=\"MBS\"").count(),
        3 * count(&mbs["tracked"]),
        "three axes a point"
    );
    let contact_s = mbs["first_ground_contact_s"].as_f64().unwrap();
    for text in [
        &format!("The structure collapses in the MBS run: first ground contact at {contact_s:.3} s"),
        "A structure counts as collapsed where a tracked point falls by more than 1 m. Not compared with FE",
        "<code>fallwerk generate-mbs --validate</code>",
        "<h2>Charges</h2>",
        "<h2>Debris</h2>",
        "<h2>The collapse in 3D</h2>",
        "at the first contact, t = ",
        "MBS energies",
        "Decisions worth a look",
        "Rules about contacts and fractures",
        "Resistance curves",
        "Simulated time",
    ] {
        assert!(page.contains(text), "{text}");
    }
    let (_, body) = page.split_once("<main>").unwrap();
    let body = body.split("id=\"scene-head\"").next().unwrap();
    for text in [
        "FE zone",
        "FE only",
        "FE energies",
        "FE internal",
        "FE mesh",
        "FE contact",
        "against FE",
        "hybrid",
        "Critical strain rate",
        "class=\"line fe\"",
        "class=\"empty\"",
        "Not recorded",
        "overlay",
    ] {
        assert!(!body.contains(text), "{text}");
    }
}
