//! The local part of a hierarchy on one rank: its rows, and PETSc's objects.

#![allow(unsafe_code)]

use std::ffi::CStr;
use std::ptr;
use std::sync::OnceLock;

use super::{Rows, sys};
use crate::expect_length;
use crate::ranks::{RankLocal, World};
use stickslip::algebra::linear::LinearError;

const NAME: &str = "PETSc";

/// The local part of a hierarchy on one rank.
pub(crate) struct Share {
    // Handles are dropped before the data that they point to.
    pc: sys::PC,
    work: [sys::Vec; 2],
    /// The ranges of rows of the ranks.
    bounds: Vec<usize>,
    /// The residual and correction of this rank, if there are several ranks.
    own: [Vec<f64>; 2],
    _matrix: Option<Box<Rows>>,
    _kernel: Vec<Vec<f64>>,
}

// SAFETY: the objects belong to one process, without thread affinity, and callers hold the lock of `ranks`.
unsafe impl Send for Share {}

/// Starts PETSc, once. All ranks must call it.
fn started() -> Result<(), LinearError> {
    static STARTED: OnceLock<Result<(), LinearError>> = OnceLock::new();
    STARTED.get_or_init(start).clone()
}

fn start() -> Result<(), LinearError> {
    const LOADED: [i32; 3] =
        [sys::PETSC_VERSION_MAJOR as i32, sys::PETSC_VERSION_MINOR as i32, sys::PETSC_VERSION_SUBMINOR as i32];
    let mut loaded = [0; 4];
    // SAFETY: the version may be queried at any time, and is written to four places; PETSc runs nothing else.
    unsafe {
        let [major, minor, sub, release] = &mut loaded;
        check("asking for its version", sys::PetscGetVersionNumber(major, minor, sub, release))?;
    }
    if loaded[..2] != LOADED[..2] {
        let [major, minor, sub, _] = loaded;
        return Err(LinearError::Version { library: NAME, built: LOADED, loaded: [major, minor, sub] });
    }
    // SAFETY: MPI runs, and PETSc uses it unchanged. Options are copied. PETSc installs no signal handlers, and
    // returns errors as statuses.
    unsafe {
        let option =
            |name: &CStr, value: &CStr| sys::PetscOptionsSetValue(ptr::null_mut(), name.as_ptr(), value.as_ptr());
        check("the start", option(c"-no_signal_handler", c"true"))?;
        check("the start", sys::PetscInitializeNoArguments())?;
        check("the start", sys::PetscPushErrorHandler(Some(sys::PetscReturnErrorHandler), ptr::null_mut()))?;
        for (name, value) in [
            (c"-symmetric_mg_levels_pc_type", c"icc"),
            (c"-shared_symmetric_mg_levels_pc_type", c"bjacobi"),
            (c"-shared_symmetric_mg_levels_sub_pc_type", c"icc"),
            (c"-oblique_mg_levels_pc_type", c"jacobi"),
            (c"-shared_oblique_mg_levels_pc_type", c"jacobi"),
        ] {
            check("its options", option(name, value))?;
        }
    }
    Ok(())
}

/// Converts the status of a failed call to an error.
fn check(step: &'static str, status: sys::PetscErrorCode) -> Result<(), LinearError> {
    const OUT_OF_MEMORY: i64 = 55;
    match i64::from(status) {
        0 => Ok(()),
        OUT_OF_MEMORY => Err(LinearError::OutOfMemory { step: "the multigrid hierarchy" }),
        status => Err(LinearError::Backend { backend: NAME, step, status }),
    }
}

/// Converts the length of an array to PETSc's 32-bit integers.
fn count(n: usize) -> Result<sys::PetscInt, LinearError> {
    sys::PetscInt::try_from(n)
        .map_err(|_| LinearError::OutOfMemory { step: "the multigrid hierarchy, whose indices have 32 bits" })
}

impl Share {
    /// Creates rank 0's part of the hierarchy of `matrix` and scatters the rows. The other ranks call
    /// [`Share::dealt`] for the rows between their `bounds`.
    pub(super) fn deal(
        world: &World,
        matrix: Rows,
        kernel: Vec<Vec<f64>>,
        bounds: &[usize],
    ) -> Result<Self, LinearError> {
        expect_length("bounds of the ranks", world.size() + 1, bounds.len())?;
        if world.size() == 1 {
            return Self::new(world, matrix, kernel, bounds.to_vec());
        }
        let order = matrix.starts.len() - 1;
        let entries: Vec<i64> = bounds.iter().map(|&row| i64::from(matrix.starts[row.min(order)])).collect();
        let mut words = vec![matrix.block as i64, i64::from(matrix.symmetric), kernel.len() as i64];
        words.extend(bounds.iter().map(|&row| row as i64));
        words.extend(entries);
        world.tell(&mut words);
        let lengths: Vec<i32> = matrix.starts.windows(2).map(|pair| pair[1] - pair[0]).collect();
        Self::received(world, &words, &lengths, &matrix.columns, &matrix.values, &kernel)
    }

    /// Creates the part of another rank.
    pub(crate) fn dealt(world: &World) -> Result<Self, LinearError> {
        let mut words = vec![0; 3 + 2 * (world.size() + 1)];
        world.tell(&mut words);
        Self::received(world, &words, &[], &[], &[], &vec![Vec::new(); words[2] as usize])
    }

    /// Receives this rank's part of the data of rank 0.
    fn received(
        world: &World,
        words: &[i64],
        lengths: &[i32],
        columns: &[i32],
        values: &[f64],
        kernel: &[Vec<f64>],
    ) -> Result<Self, LinearError> {
        let bounds =
            |at: usize| -> Vec<usize> { words[at..=at + world.size()].iter().map(|&bound| bound as usize).collect() };
        let (rows, entries) = (bounds(3), bounds(3 + world.size() + 1));
        let own = |bounds: &[usize]| bounds[world.rank() + 1] - bounds[world.rank()];
        let mut matrix = Rows {
            starts: vec![0; own(&rows) + 1],
            columns: vec![0; own(&entries)],
            values: vec![0.0; own(&entries)],
            block: words[0] as usize,
            symmetric: words[1] != 0,
        };
        world.deal_integers(lengths, &rows, &mut matrix.starts[1..])?;
        for row in 1..matrix.starts.len() {
            matrix.starts[row] += matrix.starts[row - 1];
        }
        world.deal_integers(columns, &entries, &mut matrix.columns)?;
        world.deal(values, &entries, &mut matrix.values)?;
        let motions = kernel.iter().map(|all| {
            let mut motion = vec![0.0; own(&rows)];
            world.deal(all, &rows, &mut motion).map(|()| motion)
        });
        let motions = motions.collect::<Result<_, _>>()?;
        Self::new(world, matrix, motions, rows)
    }

    /// Creates a part with these rows. All ranks must call it.
    pub(crate) fn new(
        world: &World,
        mut matrix: Rows,
        kernel: Vec<Vec<f64>>,
        bounds: Vec<usize>,
    ) -> Result<Self, LinearError> {
        started()?;
        let (alone, rows) = (world.size() == 1, matrix.starts.len() - 1);
        let (n, block) = (count(rows)?, count(matrix.block)?);
        let prefix = match (alone, matrix.symmetric) {
            (true, true) => c"symmetric_",
            (true, false) => c"oblique_",
            (false, true) => c"shared_symmetric_",
            (false, false) => c"shared_oblique_",
        };
        let symmetric = matrix.symmetric;
        let mut objects = Objects::default();
        // SAFETY: the arrays have the lengths given by `n` and the starts, and columns are below the sum of all `n`.
        // A single process uses the arrays in place; its share owns them longer than the matrix, and PETSc does not
        // write to this matrix. Several processes copy them.
        unsafe {
            let comm = sys::PETSC_COMM_WORLD;
            let (starts, columns, values) =
                (matrix.starts.as_mut_ptr(), matrix.columns.as_mut_ptr(), matrix.values.as_mut_ptr());
            let status = if alone {
                sys::MatCreateSeqAIJWithArrays(comm, n, n, starts, columns, values, &raw mut objects.matrix)
            } else {
                let all = sys::PETSC_DETERMINE;
                sys::MatCreateMPIAIJWithArrays(comm, n, n, all, all, starts, columns, values, &raw mut objects.matrix)
            };
            check("making a matrix", status)?;
            check("making a matrix", sys::MatSetBlockSize(objects.matrix, block))?;
            if symmetric {
                let option = sys::MatOption_MAT_SPD;
                check("making a matrix", sys::MatSetOption(objects.matrix, option, sys::PetscBool_PETSC_TRUE))?;
            }
        }
        let mut share = Share {
            pc: ptr::null_mut(),
            work: [ptr::null_mut(); 2],
            bounds,
            own: if alone { Default::default() } else { [vec![0.0; rows], vec![0.0; rows]] },
            _matrix: alone.then(|| Box::new(matrix)),
            _kernel: kernel,
        };
        let Share { pc, work, _kernel: kernel, .. } = &mut share;
        // SAFETY: the motions have length `n`, and live as long as the hierarchy, which refers to them. The work
        // vectors get their arrays in `apply`.
        unsafe {
            let (comm, all) = (sys::PETSC_COMM_WORLD, sys::PETSC_DETERMINE);
            let vector = |array: *const f64, vector: *mut sys::Vec| {
                if alone {
                    sys::VecCreateSeqWithArray(comm, block, n, array, vector)
                } else {
                    sys::VecCreateMPIWithArray(comm, block, n, all, array, vector)
                }
            };
            for motion in kernel.iter() {
                let mut made = ptr::null_mut();
                check("rigid motions", vector(motion.as_ptr(), &raw mut made))?;
                objects.kernel.push(made);
            }
            let motions = objects.kernel.as_ptr();
            let k = count(kernel.len())?;
            check(
                "rigid motions",
                sys::MatNullSpaceCreate(comm, sys::PetscBool_PETSC_FALSE, k, motions, &raw mut objects.space),
            )?;
            check("rigid motions", sys::MatSetNearNullSpace(objects.matrix, objects.space))?;
            check("making a hierarchy", sys::PCCreate(comm, pc))?;
            check("making a hierarchy", sys::PCSetType(*pc, c"gamg".as_ptr()))?;
            check("making a hierarchy", sys::PCSetOptionsPrefix(*pc, prefix.as_ptr()))?;
            check("making a hierarchy", sys::PCSetOperators(*pc, objects.matrix, objects.matrix))?;
            check("making a hierarchy", sys::PCSetFromOptions(*pc))?;
            check("making a hierarchy", sys::PCSetUp(*pc))?;
            for made in work {
                check("making a vector", vector(ptr::null(), made))?;
            }
        }
        Ok(share)
    }

    /// Applies one cycle, `z` with `A z ≈ r`, both on rank 0 and empty on the others. All ranks must call it.
    pub(crate) fn cycle(&mut self, world: &World, r: &[f64], z: &mut [f64]) -> Result<(), LinearError> {
        if world.size() == 1 {
            return self.apply(r, z);
        }
        self.shared_cycle(world, r, z)
    }

    /// Applies a cycle with vectors that rank 0 scatters and gathers.
    fn shared_cycle(&mut self, world: &World, r: &[f64], z: &mut [f64]) -> Result<(), LinearError> {
        let [mut residual, mut correction] = std::mem::take(&mut self.own);
        world.deal(r, &self.bounds, &mut residual)?;
        self.apply(&residual, &mut correction)?;
        world.collect(&correction, &self.bounds, z)?;
        self.own = [residual, correction];
        Ok(())
    }

    /// Applies a cycle to the rows of each rank.
    fn apply(&mut self, r: &[f64], z: &mut [f64]) -> Result<(), LinearError> {
        let [from, to] = self.work;
        // SAFETY: both arrays are as long as the vectors, and are taken back before they are used elsewhere; `r` is
        // only read.
        unsafe {
            check("a cycle", sys::VecPlaceArray(from, r.as_ptr()))?;
            let placed = sys::VecPlaceArray(to, z.as_ptr());
            let applied = if placed == 0 { sys::PCApply(self.pc, from, to) } else { placed };
            let back = [sys::VecResetArray(from), if placed == 0 { sys::VecResetArray(to) } else { 0 }];
            check("a cycle", applied)?;
            back.into_iter().try_for_each(|status| check("a cycle", status))?;
        }
        Ok(())
    }
}

impl RankLocal for Share {
    fn serve(&mut self, world: &World, _cycle: i64) -> Result<(), LinearError> {
        self.shared_cycle(world, &[], &mut [])
    }
}

impl Drop for Share {
    fn drop(&mut self) {
        let [from, to] = &mut self.work;
        // SAFETY: the handles are ours, or null, which PETSc ignores; none is used again. The hierarchy holds the
        // last references to matrix and kernel, which are therefore freed with it, before their arrays.
        unsafe {
            sys::PCDestroy(&raw mut self.pc);
            sys::VecDestroy(from);
            sys::VecDestroy(to);
        }
    }
}

/// The objects to which a hierarchy keeps references; ours end with its construction.
struct Objects {
    matrix: sys::Mat,
    space: sys::MatNullSpace,
    kernel: Vec<sys::Vec>,
}

impl Default for Objects {
    fn default() -> Self {
        Objects { matrix: ptr::null_mut(), space: ptr::null_mut(), kernel: Vec::new() }
    }
}

impl Drop for Objects {
    fn drop(&mut self) {
        // SAFETY: the handles are ours, or null; other users hold references of their own.
        unsafe {
            sys::MatNullSpaceDestroy(&raw mut self.space);
            sys::MatDestroy(&raw mut self.matrix);
            self.kernel.iter_mut().for_each(|vector| {
                sys::VecDestroy(vector);
            });
        }
    }
}
