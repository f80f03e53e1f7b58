//! Elastic-plastic-damage concrete: Drucker-Prager compression and Rankine tension (seed paper, equations 3 and 4) with what these two
//! surfaces lack.
//!
//! **Effective and nominal stress.** The mechanical strain `e` (strain less plastic strain) and the crack strains `c_i >= 0` in its principal
//! directions give the effective stress `σ̄ = C (e - c)`; the nominal stress is `σ = (1 - d) σ̄`. Plasticity hardens in effective stress all the
//! way, so that its return always exists; softening is the damage `d`, a function of the plastic strain.
//!
//! **Compression** (Lubliner, Oliver, Oller, Oñate, Int. J. Solids Struct. 25 (1989) 299-326, eq. 5):
//! `F = [α I₁ + g √(3 J₂) - γ <-σ_max>] / (1 - α) <= q(κ)`, with `α = (r - 1) / (2 r - 1)` and `γ = 3 (1 - K_c) / (2 K_c - 1)`. With `γ = 0`, `g = 1`
//! this is the seed's equation 3, `α = √3 μ`. `r` is the biaxial over the uniaxial strength. The seed's surface gains 1.41 `p` in strength from a
//! lateral pressure `p`, tests 4 to 5 `p` (Richart, Brandtzaeg and Brown 1928): that is what `K_c`, the ratio of the deviator on the tensile and
//! compressive meridians, repairs. `g = 1 + a (3√3/2) c (1 - c²)`, with `c = cos 3θ`, brings biaxial compression closer to Kupfer's tests: it is one on
//! both meridians.
//!
//! Plastic strain flows along `(3/2) s / √(3 J₂) + β 1` (Drucker-Prager, non-associated), so the deviator keeps its direction in the return
//! and the condition is one equation in one unknown, piecewise linear but for the table `q`. The hardening variable is the axial plastic strain of
//! uniaxial compression; it grows more slowly under lateral pressure, by `1 + A <-σ_max> / F`, as ductility does (Mander,
//! Priestley and Park, J. Struct. Eng. 114 (1988) 1804-1826: strain at the peak rises five times as much as the strength).
//!
//! Open cracks weaken the compression along them (optional, off: see below): with the largest crack strain `ε_cr` and the compressive strain `ε_c` the share
//! `1 / (1 + C (ε_cr / ε_c - 0.28)^0.8) <= 1` of the strength is left, `C = 0.35 · 0.55 = 0.19` where cracks slip (model A of Vecchio and Collins, J. Struct. Eng. 119 (1993)
//! 3590-3610). It decides what struts between shear cracks bear. Their strain is a mean over several cracks; a crack in a band of length `l` counts by `l` over the
//! spacing of cracks, 0.3 m. Columns with few ties then fail in shear, but at too small a force (Sezen and Moehle's first one at 345 of 361 kN m and less), and columns
//! in bending lose 2 to 5 % of their strength and up to half of their ductility: hence off.
//!
//! **Tension** (rotating smeared cracks): each principal effective stress stays below `T(c) (1 - 0.8 <-σ_min> / f_c)`, the bracket after Kupfer and
//! Gerstle (J. Eng. Mech. Div. ASCE 99 (1973) 853-866). `T` softens (Hordijk, Heron 37/1 (1992), figure 2.3) with the crack strain; below the largest one so far, it is the
//! secant to the origin; where the bracket cuts the secant off, the secant stays so low (or cycles would gain energy). A crack closes at zero crack strain with the full stiffness, and an open crack makes no lateral contraction.
//!
//! **Crack band** (Bažant and Oh, Matériaux et Constructions 16 (1983) 155-177): what an element dissipates until it bears nothing is `G_F` (tension) or `G_c`
//! (compression) per area, whatever its length `l`.
//!
//! **Unloading in compression** leaves the strain that Karsan and Jirsa measured (J. Struct. Div. ASCE 95 (1969) 2543-2563):
//! `ε_p / ε_0 = 0.145 r² + 0.13 r` up to `r = ε / ε_0 = 2`, then `0.707 (r - 2) + 0.834`.

mod backbone;
mod lanes;
mod law;
mod point;
mod principal;

pub use backbone::Backbones;
pub use lanes::respond_lanes;
pub use law::{CompressionCurve, ConcreteLaw, LawError, Surface, TensionCurve};
pub use point::{ConcretePoint, ConcreteState};
