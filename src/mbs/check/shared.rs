//! Checks of the inertial coupling of bodies.

use super::List;
use crate::mbs::latent::{merge, together};
use crate::mbs::math;
use crate::mbs::model::{Body, Model, SharedMass};
use crate::mbs::shared_mass::as_one;
use nalgebra::{Cholesky, Matrix2};
use std::collections::{BTreeMap, BTreeSet};

/// What a list may add to the inertia of its bodies as one rigid body, of that inertia.
const RIGID: f64 = 1e-6;

pub(super) fn check(model: &Model, list: &mut List) {
    if model.shared_masses.is_empty() {
        return;
    }
    let known = model.bodies.iter().map(|b| b.id.as_str()).collect();
    let latent: Vec<bool> = model.bushings.iter().map(|b| b.latent.is_some()).collect();
    let merged = merge(model, &latent);
    let bodies: BTreeMap<&str, &Body> = merged.model.bodies.iter().map(|b| (b.id.as_str(), b)).collect();
    let mut taken = BTreeSet::new();
    for (i, shared) in model.shared_masses.iter().enumerate() {
        let path = format!("shared_masses[{i}]");
        let before = list.len();
        list.without_ideal(model, &path);
        for (k, id) in shared.bodies.iter().enumerate() {
            let at = format!("{path}.bodies[{k}]");
            list.known(&known, id, &at);
            list.require(taken.insert(id), &at, || {
                format!("\"{id}\" stands in a list already: leave it out")
            });
        }
        check_blocks(shared, &path, list);
        if list.len() > before {
            continue;
        }
        match together(shared, model, (&merged.model.bodies, &merged.places)) {
            Some(shared) => check_sum(&shared, &bodies, &path, list),
            None => list.require(false, &format!("{path}.bodies"), || {
                "names bodies that latent bushings hold together: they move as one, leave out all but one"
                    .into()
            }),
        }
    }
}

fn check_blocks(shared: &SharedMass, path: &str, list: &mut List) {
    let mut seen = BTreeSet::new();
    for (k, block) in shared.blocks.iter().enumerate() {
        let [p, q] = block.pair;
        let at = format!("{path}.blocks[{k}]");
        list.require(p <= q && q < shared.bodies.len(), &format!("{at}.pair"), || {
            format!(
                "is [{p}, {q}], expected two places in the list of bodies, the first one not after the second"
            )
        });
        list.require(seen.insert([p, q]), &format!("{at}.pair"), || {
            format!("[{p}, {q}] is there twice: leave out one of them")
        });
        block.added.iter().for_each(|row| list.finite(&format!("{at}.added"), row));
        if let Some(complaint) = super::asymmetry(&block.added).filter(|_| p == q) {
            list.add(format!("{at}.added"), format!("{complaint}; that of one body has to be"));
        }
    }
}

/// All bodies as one have the inertia that they have without it, and what they have together is positive.
fn check_sum(shared: &SharedMass, bodies: &BTreeMap<&str, &Body>, path: &str, list: &mut List) {
    let added = shared.matrix();
    let mut all = added.clone();
    let own: Vec<&Body> = shared.bodies.iter().map(|id| bodies[id.as_str()]).collect();
    for (k, body) in own.iter().enumerate() {
        let r = math::qmat(body.orientation);
        let inertia = math::turned(&r, &body.inertia_kg_m2);
        all[(3 * k, 3 * k)] += body.mass_kg;
        let mut turns = all.fixed_view_mut::<2, 2>(3 * k + 1, 3 * k + 1);
        turns += Matrix2::from_fn(|a, b| inertia[a][b]);
    }
    let centres: Vec<[f64; 3]> = own.iter().map(|b| b.position_m).collect();
    let as_one = as_one(&centres);
    let [more, whole] = [&added, &all].map(|m| as_one.tr_mul(&(m * &as_one)));
    let off = (0..3)
        .any(|i| (0..3).any(|j| more[(i, j)].abs() > RIGID * (whole[(i, i)] * whole[(j, j)]).abs().sqrt()));
    list.require(!off, path, || {
        "changes the inertia of the bodies as one rigid body: blocks have to add nothing to motion along z and turns about x and y of all of them together".into()
    });
    list.require(Cholesky::new(all).is_some(), path, || {
        "takes more than the bodies have: their inertia together is not positive definite".into()
    });
}
