//! Forms found in decks of other programs: formats, zeros in place of blanks, text after keywords, included files.

use super::{CUBE, good, same, with};
use fallwerk::fe::deck::{Deck, DeckOptions, normalised, parse, read, write};
use fallwerk::fe::model::Model;
use std::fs;

/// One of each keyword, with few fields.
pub const SPARSE: &str = include_str!("sparse.k");
/// The same with the manual's defaults in its blank fields.
pub const FULL: &str = include_str!("full.k");

fn errors(text: &str) -> String {
    parse(text, "deck.k", DeckOptions::default()).map(|_| ()).unwrap_err().to_string()
}

/// A deck with identifiers of ten columns in nodes and elements.
fn ten_columns(text: &str) -> String {
    let begin = text.find("*NODE\n").unwrap();
    let wide = |line: &str| match (line.starts_with('*'), line.len()) {
        (true, _) => line.to_string(),
        (_, 56) => format!("  {line}"),
        _ => (0..line.len() / 8).map(|i| format!("{:>10}", line[8 * i..8 * i + 8].trim())).collect(),
    };
    text[..begin].to_string() + &text[begin..].lines().map(wide).collect::<Vec<_>>().join("\n")
}

#[test]
fn defaults_are_those_of_the_manual() {
    let (sparse, full) = (good(SPARSE), good(FULL));
    assert!(FULL.len() > SPARSE.len() + 1000);
    same(&sparse.model, &full.model);
    let texts = |deck: &Deck| deck.notes.iter().map(|n| n.text.clone()).collect::<Vec<_>>();
    assert_eq!(texts(&sparse), texts(&full));
}

#[test]
fn formats_of_the_whole_deck() {
    let model = good(CUBE).model;
    let ten = ten_columns(CUBE);
    same(&model, &good(&with(&ten, "*KEYWORD\n", "*KEYWORD I10=Y\n")).model);
    same(&model, &good(&with(&ten, "*KEYWORD\n", "*KEYWORD  i10 = y  LONG=S\n")).model);
    let marked = with(&ten, "*NODE\n", "*NODE %\n").replace("*ELEMENT_SOLID\n", "*ELEMENT_SOLID%\n");
    same(&model, &good(&marked).model);
    // LONG=S: standard format in, another file in long format out
    same(&model, &good(&with(CUBE, "*KEYWORD\n", "*KEYWORD LONG=S\n")).model);
    same(&model, &good(&with(CUBE, "*KEYWORD\n", "*KEYWORD_ID MEMORY=2000000\nproject\n")).model);
    for long in ["LONG=Y", "LONG=K"] {
        assert!(errors(&with(CUBE, "*KEYWORD\n", &format!("*KEYWORD {long}\n"))).contains("20 columns wide"));
    }
}

#[test]
fn text_after_a_keyword() {
    let model = good(CUBE).model;
    let named = with(CUBE, "*ELEMENT_SOLID\n", "*ELEMENT_SOLID (ten nodes format)\n");
    let deck = good(&with(&named, "*SECTION_SOLID\n", "*SECTION_SOLID   of the cube\n"));
    same(&model, &deck.model);
    assert_eq!(deck.notes.iter().filter(|n| n.text.contains("*SECTION_SOLID: the text after")).count(), 1);
    let off = "*COMMENT  *BOUNDARY_SPC_SET\n         3         0         1         1         1\n*NODE\n";
    same(&model, &good(&with(CUBE, "*NODE\n", off)).model);
}

#[test]
fn zeros_are_no_table_and_no_criterion() {
    let model = good(CUBE).model;
    let zeros = "       0.0       0.0       0.0       0.0       0.0";
    let longer =
        with(CUBE, "       0.0      0.05       0.1\n", &format!("       0.0      0.05       0.1{zeros}\n"));
    let longer = with(
        &longer,
        "     3.0e8     3.5e8     3.8e8\n",
        &format!("     3.0e8     3.5e8     3.8e8{zeros}\n"),
    );
    same(&model, &good(&longer).model);
    let none = with(
        CUBE,
        "       0.0      0.05       0.1\n     3.0e8     3.5e8     3.8e8\n",
        "0.,0.,0.,0.,0.,0.,0.,0.\n0.,0.,0.,0.,0.,0.,0.,0.\n",
    );
    let law = &good(&none).model.mesh.laws[0];
    assert_eq!(law.hardening.iter().map(|p| p.stress_pa).collect::<Vec<_>>(), [3e8]);
    let erosion =
        |third: &str| with(CUBE, "                                  0.3\n", &format!("0,0,0,0.3\n{third}"));
    same(&model, &good(&erosion("0, 0, 0, 0, 1.0, 0, 1.0, 0\n0, 10, 0, 0, 0\n, 0.5\n")).model);
    same(&model, &good(&erosion("\n         0                            \n")).model);
    let damage = errors(&erosion("1\n"));
    assert!(damage.contains("*MAT_ADD_EROSION: IDAM is `1`") && damage.contains("deck.k:"), "{damage}");
    assert!(errors(&erosion("0\n0,0,0,5e3\n")).contains("ENGCRT"));
    assert!(errors(&erosion("0\n0\n0,0,0,1e-6\n")).contains("DTMIN"));
}

#[test]
fn how_many_states() {
    let interval = |line: &str| good(&with(CUBE, "      0.02\n", line)).model.control.state_interval_s;
    assert_eq!(interval("0.02,0,0,50\n"), 0.1 / 50.0);
    assert_eq!(interval(",,,10\n"), 0.1 / 10.0);
    assert_eq!(interval("0.0\n"), 0.1 / 20.0);
    let none = good(&with(CUBE, "      0.01\n", "       0.0         3         0         1\n"));
    assert_eq!(none.model.control.history_interval_s, 0.1 / 100.0);
    assert!(errors(&with(CUBE, "      0.02\n", "-0.02\n")).contains("DT is `-0.02`"));
}

#[test]
fn contact_of_all_parts_by_name() {
    let contact = |head: &str| {
        with(
            CUBE,
            "*NODE\n",
            &format!(
                "*SET_PART_LIST\n5\n10\n*SET_PART_LIST\n6\n\n*CONTACT_AUTOMATIC_SINGLE_SURFACE\n{head}\n0.3\n*NODE\n"
            ),
        )
    };
    for head in ["0", "5,0,2", "10,0,3", "9,0,5"] {
        assert_eq!(good(&contact(head)).model.body_contact.map(|c| c.friction), Some(0.3), "{head}");
    }
    for (head, said) in [
        ("6,0,2", "leaves out part 10"),
        ("11,0,3", "leaves out part 10"),
        ("7,0,2", "no set of parts 7"),
        ("5,0,0", "SSID is `5`"),
    ] {
        assert!(errors(&contact(head)).contains(said), "{head}: {}", errors(&contact(head)));
    }
}

#[test]
fn an_entry_in_place_of_a_heading() {
    let twice = "*BOUNDARY_SPC_SET_ID\n1,foot\n3,0,1,1,0\n2,again 2\n3,0,0,0,1\n";
    let plain = "*BOUNDARY_SPC_SET\n         3         0         1         1         0\n";
    assert_eq!(good(&with(CUBE, plain, twice)).model.mesh.fixed.len(), 4);
    let text = errors(&with(CUBE, plain, &twice.replace("2,again 2\n", "3,0,0,1,0\n")));
    assert!(text.contains("*BOUNDARY_SPC_SET_ID: numbers in place of an identifier and a heading"), "{text}");
}

#[test]
fn sets_of_nodes_by_part() {
    let model = good(CUBE).model;
    let list = "*SET_NODE_LIST\n         3\n         1         2         3         4\n";
    let general =
        |lines: &str| with(CUBE, list, &format!("*SET_NODE_GENERAL_TITLE\nfoot\n         3\n{lines}"));
    same(&model, &good(&general("NODE               4         1         2\nnode,3,1\n")).model);
    for all in ["ALL\n", "PART              10\n"] {
        assert_eq!(good(&general(all)).model.constraints.len(), 8, "{all}");
    }
    for (lines, said) in [
        ("BOX                1\n", "OPTION is `BOX`"),
        ("PART              11\n", "no part 11"),
        ("NODE               9\n", "no node 9"),
    ] {
        assert!(errors(&general(lines)).contains(said), "{}", errors(&general(lines)));
    }
    let twice = general("ALL\n") + list;
    assert!(errors(&twice.replace("*END\n", "")).contains("set of nodes 3 is defined twice"));
}

fn files(room: &tempfile::TempDir, files: &[(&str, String)]) -> Model {
    for (name, text) in files {
        let path = room.path().join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    }
    read(&room.path().join("main.k"), DeckOptions::default()).unwrap_or_else(|e| panic!("{e}")).model
}

/// Included files end with `*END` of their own, stand in other folders and have other formats.
#[test]
fn included_files_of_all_kinds() {
    let model = good(CUBE).model;
    let (nodes, solid) = (CUBE.find("*NODE\n").unwrap(), CUBE.find("*ELEMENT_SOLID\n").unwrap());
    let part = |from: usize, to: usize| format!("*KEYWORD\n{}*END\nnot read\n", &CUBE[from..to]);
    let end = CUBE.find("*END").unwrap();
    let room = tempfile::tempdir().unwrap();
    let main = |tail: &str| ("main.k", format!("\u{feff}{}{tail}", &CUBE[..nodes]));
    let nested = ("mesh/all.k", "*KEYWORD\n*INCLUDE\nmesh/nodes.k\nsolid.k\n*END\n".to_string());
    let parts = [("mesh/nodes.k", part(nodes, solid)), ("mesh/solid.k", part(solid, end))];
    let [one, two] = parts.clone();
    // beside the file that includes, or beside the deck; backslashes
    same(&model, &files(&room, &[main("*INCLUDE\nmesh\\all.k\n*END\n"), nested, one, two]));
    let room = tempfile::tempdir().unwrap();
    let [one, two] = parts.clone();
    let path = "*INCLUDE_PATH\nelsewhere\nmesh\n*INCLUDE\nnodes.k\nsolid.k\n*END\n";
    same(&model, &files(&room, &[main(path), one, two]));
    // a sign after *INCLUDE is the format of the file; LONG in it has no effect
    let ten = ten_columns(&CUBE[nodes..end]).replace("*NODE", "*KEYWORD LONG=Y\n*NODE") + "\n*END\n";
    let room = tempfile::tempdir().unwrap();
    same(&model, &files(&room, &[main("*INCLUDE %\nmesh.k\n*END\n"), ("mesh.k", ten)]));
}

/// What other programs need of a deck: no blank lines for cards, exponents with an `e`.
#[test]
fn written_for_other_programs() {
    let mut model = good(SPARSE).model;
    model.mesh.laws.iter_mut().for_each(|l| l.rate = None);
    model.mesh.nodes[0][0] = -1.234_567_8e-12;
    let (normal, _) = normalised(&model);
    let text = write(&model, &[]).text;
    same(&normal, &good(&text).model);
    assert!(text.lines().all(|l| !l.trim().is_empty()), "{text}");
    assert!(text.contains("-1.2345678e-12"), "{text}");
    let step = text.lines().skip_while(|l| *l != "*CONTROL_TIMESTEP").nth(1).unwrap();
    assert_eq!(
        step.split_whitespace().collect::<Vec<_>>(),
        ["0.0", "0.8", "-1e-5", "1"],
        "mass is added once: MS1ST"
    );
    assert_eq!(step.len(), 80);
}

/// Vectors whose length squared is lost or has no bounds give no direction.
#[test]
fn lengths_out_of_reach() {
    let wall = "       0.0       0.0       0.0       0.0       0.0       1.0       0.4";
    for z in ["1e-200", "1e200"] {
        let text = errors(&with(CUBE, wall, &format!("0,0,0,0,0,{z},0.4")));
        assert!(text.contains("*RIGIDWALL_PLANAR: XH is"), "{text}");
        let spin = format!("*INITIAL_VELOCITY_GENERATION\n10,2,3.0\n0,0,0,0,0,{z}\n*NODE\n");
        let text = errors(&with(CUBE, "*NODE\n", &spin));
        assert!(text.contains("*INITIAL_VELOCITY_GENERATION: NX is"), "{text}");
    }
}

#[test]
fn expressions_are_refused_by_name() {
    let text = errors(&with(CUBE, "*PART\n", "*PARAMETER_EXPRESSION\nR e  2*1e11\n*PART\n"));
    assert!(text.contains("expressions are not computed") && text.contains("deck.k:"), "{text}");
}
