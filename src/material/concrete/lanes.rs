//! Points side by side: what all of them need is done in loops without branch or call, which the compiler turns into vector code; only the
//! return of principal stresses to the surfaces is a call for each point that needs it.

use super::point::{ConcretePoint, ConcreteState};
use super::principal::{assemble, principal};

/// Nominal stresses after strain increments (tensor components, `[component][lane]`) \[Pa\], and the strains less plastic strains. Lanes that do not act
/// keep their states; what is written for them means nothing.
#[inline(always)]
pub fn respond_lanes<const N: usize>(
    points: &[&ConcretePoint; N],
    states: &mut [ConcreteState],
    increments: &[[f64; N]; 6],
    acts: &[bool; N],
    [stress, mechanical]: [&mut [[f64; N]; 6]; 2],
) {
    let mut history = History::of(points, states);
    for l in 0..N {
        for i in 0..6 {
            mechanical[i][l] = states[l].mechanical[i] + increments[i][l];
        }
    }
    let mut fits = [true; N];
    for l in 0..N {
        let strain = lane(mechanical, l);
        let (elastic, inside) = history.elastic(l, &strain);
        for i in 0..6 {
            stress[i][l] = elastic[i];
        }
        fits[l] = inside || !acts[l];
    }
    if fits.iter().any(|f| !f) {
        settle_lanes(points, states, increments, &mut history, &fits, [&mut *stress, &mut *mechanical]);
    }
    for l in 0..N {
        if acts[l] {
            states[l].mechanical = lane(mechanical, l);
        }
    }
}

/// The full law in the lanes that do not fit.
#[inline(always)]
fn settle_lanes<const N: usize>(
    points: &[&ConcretePoint; N],
    states: &mut [ConcreteState],
    increments: &[[f64; N]; 6],
    history: &mut History<N>,
    fits: &[bool; N],
    [stress, mechanical]: [&mut [[f64; N]; 6]; 2],
) {
    let (mut values, mut q) = ([[0.0; N]; 3], [[0.0; N]; 9]);
    for l in 0..N {
        let (own, directions) = principal(&lane(mechanical, l));
        for k in 0..3 {
            values[k][l] = own[k];
            for i in 0..3 {
                q[3 * k + i][l] = directions[k][i];
            }
        }
    }
    let mut nominal = [[0.0; N]; 3];
    let (mut settled, mut flowed) = ([false; N], [false; N]);
    for l in (0..N).filter(|l| !fits[*l]) {
        let (point, state) = (points[l], &mut states[l]);
        let count = point.sub_steps(&lane(increments, l));
        if count > 1 {
            let own = point.respond_in_steps(state, &lane(increments, l), count);
            for i in 0..6 {
                stress[i][l] = own[i];
                mechanical[i][l] = state.mechanical[i];
            }
            continue;
        }
        let own = point.settle([values[0][l], values[1][l], values[2][l]], state, history.left[l]);
        for k in 0..3 {
            nominal[k][l] = own.nominal[k];
            values[k][l] = own.strain[k];
        }
        (settled[l], flowed[l]) = (true, own.flowed);
    }
    for l in 0..N {
        let mut directions = [[0.0; 3]; 3];
        for k in 0..3 {
            for i in 0..3 {
                directions[k][i] = q[3 * k + i][l];
            }
        }
        let new = assemble(&[nominal[0][l], nominal[1][l], nominal[2][l]], &directions);
        let strain = assemble(&[values[0][l], values[1][l], values[2][l]], &directions);
        for i in 0..6 {
            stress[i][l] = if settled[l] { new[i] } else { stress[i][l] };
            mechanical[i][l] = if flowed[l] { strain[i] } else { mechanical[i][l] };
        }
    }
}

/// Constants and history by lane, as far as the elastic range needs them.
struct History<const N: usize> {
    lambda: [f64; N],
    two_mu: [f64; N],
    of_mean: [f64; N],
    of_mises: [f64; N],
    reduction: [f64; N],
    reduction_1_pa: [f64; N],
    /// Tensile stress that it bears without a crack \[Pa\].
    tensile: [f64; N],
    /// Effective strength \[Pa\].
    strength: [f64; N],
    /// `1 - d`.
    left: [f64; N],
}

impl<const N: usize> History<N> {
    #[inline(always)]
    fn of(points: &[&ConcretePoint; N], states: &mut [ConcreteState]) -> Self {
        let mut this = Self {
            lambda: [0.0; N],
            two_mu: [0.0; N],
            of_mean: [0.0; N],
            of_mises: [0.0; N],
            reduction: [0.0; N],
            reduction_1_pa: [0.0; N],
            tensile: [0.0; N],
            strength: [0.0; N],
            left: [1.0; N],
        };
        for l in 0..N {
            let (screen, state) = (&points[l].screen, &mut states[l]);
            (this.lambda[l], this.two_mu[l]) = (screen.lambda, screen.two_mu);
            (this.of_mean[l], this.of_mises[l]) = (screen.of_mean, screen.of_mises);
            (this.reduction[l], this.reduction_1_pa[l]) = (screen.reduction, screen.reduction_1_pa);
            // a crack that is there opens under any tension
            this.tensile[l] = if state.crack > 0.0 { 0.0 } else { screen.tensile };
            this.strength[l] = screen.elastic_limit;
            if state.plastic > 0.0 {
                [this.left[l], this.strength[l]] = points[l].hardened(state);
            }
        }
        this
    }

    /// The nominal stress without cracks or flow \[Pa\], and whether bounds by the invariants show that there are none.
    #[inline(always)]
    fn elastic(&self, l: usize, strain: &[f64; 6]) -> ([f64; 6], bool) {
        let (volumetric, two_mu, left) =
            (self.lambda[l] * (strain[0] + strain[1] + strain[2]), self.two_mu[l], self.left[l]);
        let mut stress = [0.0; 6];
        for i in 0..3 {
            stress[i] = volumetric + two_mu * strain[i];
            stress[i + 3] = two_mu * strain[i + 3];
        }
        let mean = (stress[0] + stress[1] + stress[2]) * (1.0 / 3.0);
        let (a, b, c) = (stress[0] - stress[1], stress[1] - stress[2], stress[2] - stress[0]);
        let shear = stress[3] * stress[3] + stress[4] * stress[4] + stress[5] * stress[5];
        let mises = (0.5 * (a * a + b * b + c * c) + 3.0 * shear).sqrt();
        // principal stresses are within 2/3 of the Mises stress of the mean
        let (most, least) = (mean + 2.0 / 3.0 * mises, mean - 2.0 / 3.0 * mises);
        let loss = -least * left * self.reduction_1_pa[l];
        let loss = if loss > 0.0 { loss } else { 0.0 };
        let loss = if loss < self.reduction[l] { loss } else { self.reduction[l] };
        let whole = most <= self.tensile[l] * (1.0 - loss);
        let inside = self.of_mean[l] * mean + self.of_mises[l] * mises <= self.strength[l];
        for s in &mut stress {
            *s *= left;
        }
        (stress, whole && inside)
    }
}

/// One lane.
#[inline(always)]
fn lane<const N: usize>(values: &[[f64; N]; 6], l: usize) -> [f64; 6] {
    std::array::from_fn(|i| values[i][l])
}
