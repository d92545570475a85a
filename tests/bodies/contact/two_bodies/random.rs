//! Random bodies on each other, judged on the stiffness of the bodies by themselves.

use crate::common::pairs::paired;
use crate::common::prelude::*;

/// Two blocks with a random gap or interference, pressed and pushed to and fro.
fn scene(random: &mut Random) -> Description {
    let space = random.next() < 0.3;
    let mut count = |least: usize, more: f64| least + (more * random.next()) as usize;
    let elements = [count(2, 6.0), count(2, 6.0), count(1, 3.0), count(1, 3.0)];
    let contrast = 10_f64.powf(8.0 * random.next() - 4.0);
    let (lower, upper) = (1e9_f64, 1e9 * contrast);
    let softer = lower.min(upper);
    let (from, width) = (0.3 * random.next(), 0.5 + 0.4 * random.next());
    let block = |width: f64, n: usize, high: usize| {
        if space {
            return MeshSource::block([width, 0.6, 0.5], [n.min(4), 2 + n % 2, high.min(2)]);
        }
        MeshSource::block([width, 0.5], [n, high])
    };
    let at = if space { [from, 0.1, 0.5].into() } else { [from, 0.5].into() };
    let description = bodies(
        (block(1.0, elements[0], elements[2]), lower),
        (block(width, elements[1], elements[3]), upper),
        Some(at),
        equal_increments(6.0, 6),
    );
    let slave = if random.next() < 0.5 { Side::Upper } else { Side::Lower };
    let mut description = paired(description, slave, 1.5 * random.next());
    let gap = 1e-4 * random.sign();
    let opposite = description.contacts[0].opposite().unwrap().clone();
    description.contacts[0].against =
        stickslip::body::Against::Boundary(Opposite { gap: Some(gap.into()), ..opposite });
    let pressure = softer * (2e-4 + 1e-3 * random.next());
    let (push, aside) = (0.6 * pressure * random.sign(), 0.3 * pressure * random.sign());
    let axes: &[Axis] = if space { &[Axis::X, Axis::Y, Axis::Z] } else { &[Axis::X, Axis::Y] };
    let along = |x: f64, y: f64, up: f64| if space { vec![x, y, up] } else { vec![x, up] };
    description
        .support("lower:bottom", axes)
        .load(Load::new("upper:top", &along(0.0, 0.0, -pressure)).over(&[[0.0, 0.0], [2.0, 1.0]]))
        .load(Load::new("upper:top", &along(push, aside, 0.0)).over(&[[2.0, 0.0], [4.0, 1.0], [6.0, -1.0]]))
}

/// Whether the whole block upon the other tips over, or slides away, is for the verdict to say; here states that it calls converged
/// are judged.
struct Judge<'a> {
    model: &'a Model,
    last: Vec<[f64; 2]>,
    worst: f64,
}

impl Judge<'_> {
    /// The largest error of equilibrium at any node, and of the laws, in units of the forces and displacements.
    fn error(&mut self, time: f64, state: &State) -> f64 {
        let Model { mesh, .. } = self.model;
        let contacts = &self.model.contact.nodes;
        let dimension = mesh.dimension;
        let held = |node: usize, _: usize| mesh.nodes[node][dimension - 1] == 0.0;
        let dofs = Dofs::new(mesh, held);
        let stiffness = assemble(mesh, &dofs, self.model.element(), |e| self.model.materials()[e]).unwrap();
        let u = self.model.displacements(time, &state.u).unwrap();
        let unknowns = dofs.unknowns(|node| u[node]);
        let mut left = stiffness.times(&unknowns).unwrap();
        let mut size = 0.0_f64;
        for load in &self.model.description().loads {
            let stickslip::body::Action::Traction { boundary, traction } = &load.action else { panic!() };
            let t: Vec<f64> = traction.iter().map(|t| t.uniform().unwrap()).collect();
            let t = [t[0], t[1], t.get(2).copied().unwrap_or_default()];
            let points = load.history.clone().unwrap();
            let after = points.iter().position(|[end, _]| time <= *end).unwrap_or(points.len() - 1).max(1);
            let [[t0, f0], [t1, f1]] = [points[after - 1], points[after]];
            let factor = f0 + (f1 - f0) * ((time - t0) / (t1 - t0)).clamp(0.0, 1.0);
            for (left, f) in left.iter_mut().zip(facet_load(mesh, &dofs, mesh.boundary(boundary).unwrap(), t)) {
                *left -= factor * f;
                size = size.max((factor * f).abs());
            }
        }
        let length = u.iter().flatten().fold(1e-4_f64, |m, u| m.max(u.abs()));
        let mut laws = 0.0_f64;
        let largest = state.p_n.iter().fold(size, |m, p| m.max(p.abs()));
        for (i, contact) in contacts.iter().enumerate() {
            let dot = |a: [f64; 3], b: [f64; 3]| (0..3).map(|c| a[c] * b[c]).sum::<f64>();
            let [p_n, p_t, p_o] = [state.p_n[i], state.p_t[i], state.p_o[i]];
            let [t, o] = contact.facing.tangents;
            let along = |n: [f64; 3]| contact.sum(|term| dot(u[term.node], n));
            for term in contact.terms() {
                let force = [0, 1, 2].map(|c| p_n * contact.facing.normal[c] + p_t * t[c] + p_o * o[c]);
                for (dof, f) in dofs.along(term.node, force) {
                    left[dof] += term.coefficient * f;
                }
            }
            let gap = (contact.facing.gap - along(contact.facing.normal)) / length;
            let mu = self.model.problem.mu()[i];
            let slip = [along(t), along(o)];
            let moved = [slip[0] - self.last[i][0], slip[1] - self.last[i][1]];
            self.last[i] = slip;
            let friction = p_t.hypot(p_o);
            laws = laws.max(-gap).max(-p_n / largest).max(gap.min(p_n / largest)).max((friction - mu * p_n) / largest);
            // What slips is opposed by all the friction there is.
            let distance = moved[0].hypot(moved[1]);
            if distance > 0.0 && !contact.tangents[0].is_empty() {
                let against = (p_t - mu * p_n * moved[0] / distance).hypot(p_o - mu * p_n * moved[1] / distance);
                laws = laws.max((against / largest).min(distance / length));
            }
        }
        // Rounding of displacements, beside what strains the stiffer body.
        let rounding = stiffness.diagonal().into_iter().fold(0.0, f64::max) * length * 1e-15;
        let left = left.into_iter().fold(0.0_f64, |m, f| m.max(f.abs()));
        laws.max(left / (largest + rounding / 1e-9))
    }
}

impl Observer for Judge<'_> {
    fn increment(&mut self, step: &IncrementView<'_>) -> ControlFlow<()> {
        if step.record.status == Status::Converged {
            let error = self.error(step.record.time, step.state);
            self.worst = self.worst.max(error);
            assert!(
                step.statuses
                    .iter()
                    .all(|status| matches!(status, ContactStatus::Open | ContactStatus::Stick | ContactStatus::Slip))
            );
        }
        ControlFlow::Continue(())
    }
}

#[test]
fn random_pairs_are_right() {
    let mut random = Random(17);
    let mut converged = 0;
    for k in 0..30 {
        let model = Model::build(&scene(&mut random)).unwrap();
        let verdicts = [Method::BN, Method::Ip].map(|method| {
            let mut judge = Judge { model: &model, last: vec![[0.0; 2]; model.contact.nodes.len()], worst: 0.0 };
            let run = Run::of(&model, model.times().to_vec(), SolverChoice::new(method)).unwrap();
            let outcome = run.history(&mut judge).unwrap();
            assert!(judge.worst < 3e-9, "scene {k}, {method:?}: {:e}", judge.worst);
            (outcome.status, outcome.reached)
        });
        let [bn, ip] = verdicts;
        assert!(bn.0 == ip.0 && (bn.1 - ip.1).abs() <= 1e-12 * bn.1, "scene {k}: {verdicts:?}");
        converged += usize::from(verdicts[0].0 == Status::Converged);
    }
    assert!(converged > 15, "{converged}");
}
