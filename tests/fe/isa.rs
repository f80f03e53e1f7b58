//! Every instruction set gives the same run, to the last bit.

use super::mesh::{bilinear, grid, ground, of_hexahedra};
use fallwerk::base::isa::Isa;
use fallwerk::fe::contact::BodyContact;
use fallwerk::fe::dynamics::{Death, Dynamics};
use fallwerk::fe::law::{ElementForm, Hourglass};
use fallwerk::fe::mesh::Mesh;
use fallwerk::fe::model::ContactSettings;

/// A block close above the ground, and a skew one above it; both flow at 2 MPa and erode at a plastic strain of 0.08.
fn two_blocks(form: ElementForm) -> Mesh {
    let mut law = bilinear(30e9, 0.2, 2500.0, 2e6, 300e6);
    law.erosion.plastic_strain = 0.08;
    law.form = form;
    let lower = grid([4, 4, 3], [0.8, 0.8, 0.6], law.clone(), |_| false);
    let upper = grid([3, 3, 5], [0.5, 0.5, 0.9], law.clone(), |_| false);
    let mut nodes = lower.nodes.clone();
    nodes.extend(upper.nodes.iter().map(|p| [p[0] + 0.11 + 0.1 * p[2], p[1] + 0.17, p[2] + 0.61]));
    let first = lower.nodes.len();
    let hexahedra = lower.elements.iter().map(|e| e.nodes);
    let hexahedra = hexahedra.chain(upper.elements.iter().map(|e| e.nodes.map(|n| n + first))).collect();
    let mut mesh = of_hexahedra(nodes, hexahedra, law, Vec::new());
    for element in &mut mesh.elements[lower.elements.len()..] {
        element.part = 1;
    }
    mesh.parts = vec!["lower".into(), "upper".into()];
    mesh
}

/// What a run is compared by, and which elements eroded.
fn run(form: ElementForm, isa: Isa) -> (String, usize, Dynamics) {
    let mesh = two_blocks(form);
    let mut body = Dynamics::new(&mesh, 9.81, ground(-0.005, 0.5), false);
    body.isa = isa;
    body.skip_quiet = true;
    body.body_contact = Some(Box::new(BodyContact::new(&mesh, ContactSettings { friction: 0.4 })));
    for n in (0..body.x.len()).filter(|n| mesh.nodes[*n][2] > 0.605) {
        body.v[n] = [3.0, 1.0, -40.0];
    }
    let mut eroded = 0;
    let mut kinetic_j = Vec::new();
    for _ in 0..300 {
        kinetic_j.push(body.step(true).to_bits());
        eroded += body.deaths.iter().filter(|(_, cause)| *cause == Death::Eroded).count();
    }
    body.isa = Isa::Portable;
    // numbers are printed with as many digits as tell them apart
    (format!("{kinetic_j:?} {body:?}"), eroded, body)
}

#[test]
fn a_run_with_flow_erosion_and_contact_is_the_same_with_every_instruction_set() {
    for form in [ElementForm::default(), ElementForm::OnePoint(Hourglass::Ads), ElementForm::FullyIntegrated]
    {
        let (portable, eroded, body) = run(form, Isa::Portable);
        let elements = body.blocks.elements();
        let flowed = (0..elements).filter(|e| body.blocks.plastic_strain(*e) > 0.0).count();
        assert!(eroded > 3 && eroded < elements / 2, "{form:?}: {eroded} of {elements} eroded");
        assert!(flowed > elements / 2, "{form:?}: {flowed} of {elements} flowed");
        assert!(body.body_contact.as_ref().unwrap().summary().most_contacts > 3, "{form:?}");
        assert!(!body.surfaces.new_touches.is_empty() && body.contact_j[0] < 0.0, "{form:?}");
        for isa in Isa::available() {
            assert!(run(form, isa).0 == portable, "{form:?}: {isa:?} differs from the portable code");
        }
    }
}
