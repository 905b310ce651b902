//! The fronts of a factorisation and where their numbers are.

use super::Pattern;
use faer::perm::PermRef;
use faer::sparse::linalg::cholesky::supernodal::SymbolicSupernodalCholesky;
use std::ops::Range;

/// Multiplications of a factorisation from which its subtrees are shared among the threads of rayon's current
/// pool. To wake a thread takes 0.1 ms, so that two threads need 1.05 times the time of one for
/// factorisations in steps of sheets of 688 and 876 vertices (7 to 10 million multiplications), 0.97 times
/// for 1089 vertices (10 million) and 0.82 times for 4225 vertices (84 million).
pub(super) const WORTH_SHARING: f64 = 2e7;

/// Adjacent columns of the factor with the same rows below.
#[derive(Debug, Clone)]
pub(super) struct Front {
    /// First column.
    pub(super) start: usize,
    pub(super) columns: usize,
    /// Rows below the columns.
    pub(super) rows: usize,
    /// The columns in the values of the factor.
    pub(super) values: Range<usize>,
    /// Values of the matrix, in [`Plan::entries`].
    pub(super) entries: Range<usize>,
    /// Rows, in [`Plan::places`] and [`Plan::rows`].
    pub(super) places: Range<usize>,
    /// Children, in [`Plan::children`].
    pub(super) children: Range<usize>,
    /// Where the update is computed, and where it is kept for the parent. It is a square matrix with a row
    /// for each row of the front.
    pub(super) work: usize,
    pub(super) update: usize,
}

impl Front {
    /// Multiplications, without square roots and divisions.
    fn operations(&self) -> f64 {
        let (c, r) = (self.columns as f64, self.rows as f64);
        c * (c * c / 6.0 + c * r / 2.0 + r * r / 2.0)
    }
}

/// Fronts that depend on no others.
#[derive(Debug, Clone)]
pub(super) struct Subtree {
    pub(super) fronts: Range<usize>,
    /// Their columns in the values of the factor.
    pub(super) values: Range<usize>,
    /// Room for their updates.
    pub(super) updates: Range<usize>,
    /// The unknowns that they eliminate.
    pub(super) columns: Range<usize>,
    /// The unknowns above that they depend on, in [`Plan::above`].
    pub(super) above: Range<usize>,
    /// Their room for triangular solves: for values of both kinds of unknowns, and of the rows of a front.
    pub(super) local: Range<usize>,
    /// Multiplications of the subtrees before it, and with its own.
    operations: [f64; 2],
}

impl Subtree {
    /// Cuts a list of two subtrees or more near the middle of the operations.
    pub(super) fn halves(list: &[Self]) -> (&[Self], &[Self]) {
        let ([first, _], [_, last]) = (list[0].operations, list[list.len() - 1].operations);
        let middle = 0.5 * (first + last);
        // The subtree in the middle belongs to the half that has more of it.
        let cut = list.partition_point(|t| 0.5 * (t.operations[0] + t.operations[1]) < middle);
        list.split_at(cut.clamp(1, list.len() - 1))
    }
}

/// What to do in which order.
#[derive(Debug)]
pub(super) struct Plan {
    /// In the order of elimination, a postorder of the elimination tree: subtrees are ranges.
    pub(super) fronts: Vec<Front>,
    /// Of each value of the matrix its place in the columns of its front, and its number.
    pub(super) entries: Vec<[u32; 2]>,
    /// Of each row of a front its place in the parent, among columns and rows.
    pub(super) places: Vec<u32>,
    /// Each row of a front as a number of an unknown: in subtrees counted from the first unknown of the
    /// subtree, and those [above](Subtree::above) after its own.
    pub(super) rows: Vec<u32>,
    /// The unknowns above each subtree on which it depends.
    pub(super) above: Vec<u32>,
    pub(super) children: Vec<u32>,
    /// The largest subtrees with no more than half of the operations each; whole trees where so few
    /// operations are not shared.
    pub(super) subtrees: Vec<Subtree>,
    /// The fronts above them, each but the first the parent of the one before.
    pub(super) trunk: Vec<u32>,
    /// Multiplications.
    pub(super) operations: f64,
    /// Number of values that updates take.
    pub(super) room: usize,
    /// Number of values that triangular solves take, and the part of them for rows of the trunk.
    pub(super) locals: usize,
    pub(super) trunk_scratch: Range<usize>,
}

impl Plan {
    /// The plan; nothing if the supernodes are in no postorder of the elimination tree.
    pub(super) fn new(
        pattern: &Pattern,
        perm: PermRef<'_, usize>,
        symbolic: &SymbolicSupernodalCholesky<usize>,
    ) -> Option<Self> {
        let mut plan = Self {
            fronts: Vec::new(),
            entries: vec![[0; 2]; pattern.len()],
            places: Vec::new(),
            rows: Vec::new(),
            above: Vec::new(),
            children: Vec::new(),
            subtrees: Vec::new(),
            trunk: Vec::new(),
            operations: 0.0,
            room: 0,
            locals: 0,
            trunk_scratch: 0..0,
        };
        let front_of = plan.add_fronts(symbolic, pattern);
        plan.divide()?;
        plan.number_rows(symbolic);
        plan.place_entries(pattern, perm, symbolic, &front_of);
        Some(plan)
    }

    /// Fronts with their children; returns the front of each column.
    fn add_fronts(
        &mut self,
        symbolic: &SymbolicSupernodalCholesky<usize>,
        pattern: &Pattern,
    ) -> Vec<usize> {
        let (begin, end) = (symbolic.supernode_begin(), symbolic.supernode_end());
        let (values, rows) = (symbolic.col_ptr_for_val(), symbolic.col_ptr_for_row_idx());
        let count = symbolic.n_supernodes();
        let mut front_of = vec![0; pattern.cols()];
        for s in 0..count {
            front_of[begin[s]..end[s]].fill(s);
        }
        let parents: Vec<Option<usize>> = (0..count)
            .map(|s| symbolic.supernode(s).pattern().first())
            .map(|row| row.map(|&row| front_of[row]))
            .collect();
        let child_parents = || parents.iter().flatten().copied();
        let first_child = grouped(count, child_parents());
        let mut next = first_child.clone();
        self.children = vec![0; first_child[count]];
        for (s, parent) in parents.iter().enumerate() {
            if let Some(parent) = *parent {
                self.children[next[parent]] = number(s);
                next[parent] += 1;
            }
        }
        self.places = vec![0; rows[count]];
        self.fronts.extend((0..count).map(|s| Front {
            start: begin[s],
            columns: end[s] - begin[s],
            rows: rows[s + 1] - rows[s],
            values: values[s]..values[s + 1],
            entries: 0..0,
            places: rows[s]..rows[s + 1],
            children: first_child[s]..first_child[s + 1],
            work: 0,
            update: 0,
        }));
        front_of
    }

    /// Finds where in the fronts the values of the matrix and the rows of the children belong.
    fn place_entries(
        &mut self,
        pattern: &Pattern,
        perm: PermRef<'_, usize>,
        symbolic: &SymbolicSupernodalCholesky<usize>,
        front_of: &[usize],
    ) {
        let position = perm.arrays().1;
        // Columns and numbers of the values, by fronts.
        let ends = |j: usize, k: usize| (position[pattern.row_idx()[k]], position[j]);
        let all = || {
            let columns = pattern.col_ptr().windows(2).enumerate();
            columns.flat_map(|(j, range)| (range[0]..range[1]).map(move |k| (j, k)))
        };
        let front = |(j, k)| {
            let (a, b) = ends(j, k);
            front_of[a.min(b)]
        };
        let first_entry = grouped(self.fronts.len(), all().map(front));
        let mut next = first_entry.clone();
        for (j, k) in all() {
            let s = front((j, k));
            self.entries[next[s]] = [number(j), number(k)];
            next[s] += 1;
        }
        // Places of rows in one front after the other.
        let mut place = vec![0; pattern.cols()];
        for (s, front) in self.fronts.iter_mut().enumerate() {
            let columns = front.start..front.start + front.columns;
            for (p, row) in columns
                .chain(symbolic.supernode(s).pattern().iter().copied())
                .enumerate()
            {
                place[row] = p;
            }
            front.entries = first_entry[s]..first_entry[s + 1];
            let height = front.columns + front.rows;
            for entry in &mut self.entries[front.entries.clone()] {
                let (a, b) = ends(entry[0] as usize, entry[1] as usize);
                entry[0] = number(place[a.min(b)] * height + place[a.max(b)]);
            }
            for &child in &self.children[front.children.clone()] {
                let rows = symbolic.supernode(child as usize).pattern();
                let first = symbolic.col_ptr_for_row_idx()[child as usize];
                for (p, &row) in self.places[first..].iter_mut().zip(rows) {
                    *p = number(place[row]);
                }
            }
        }
    }

    /// Divides the fronts into subtrees and trunk, and the room for updates among them. Returns nothing if
    /// subtrees are not ranges.
    fn divide(&mut self) -> Option<()> {
        let count = self.fronts.len();
        // Operations and number of the fronts of each subtree.
        let mut operations: Vec<f64> = self.fronts.iter().map(Front::operations).collect();
        self.operations = operations.iter().sum();
        let mut sizes = vec![1; count];
        let mut parent = vec![None; count];
        for s in 0..count {
            let mut first = s;
            for &child in self.children[self.fronts[s].children.clone()].iter().rev() {
                let child = child as usize;
                if child + 1 != first {
                    return None;
                }
                first -= sizes[child];
                sizes[s] += sizes[child];
                operations[s] += operations[child];
                parent[child] = Some(s);
            }
        }
        // What is not shared stays in one piece.
        let half = match self.operations >= WORTH_SHARING {
            true => 0.5 * self.operations,
            false => f64::INFINITY,
        };
        let is_large = |s: usize| operations[s] > half;
        let (trunk, small): (Vec<usize>, Vec<usize>) = (0..count).partition(|&s| is_large(s));
        let mut before = 0.0;
        for s in small
            .into_iter()
            .filter(|&s| parent[s].is_none_or(is_large))
        {
            let fronts = s + 1 - sizes[s]..s + 1;
            let updates = self.room..self.room + self.stack(fronts.clone());
            self.room = updates.end;
            self.subtrees.push(Subtree {
                values: self.fronts[fronts.start].values.start..self.fronts[s].values.end,
                columns: self.fronts[fronts.start].start
                    ..self.fronts[s].start + self.fronts[s].columns,
                fronts,
                updates,
                above: 0..0,
                local: 0..0,
                operations: [before, before + operations[s]],
            });
            before += operations[s];
        }
        // Each front of the trunk needs the update of the one before only: two places take turns.
        let squares = trunk.iter().map(|&s| self.fronts[s].rows.pow(2));
        let most = squares.max().unwrap_or(0);
        for (k, &s) in trunk.iter().enumerate() {
            let update = self.room + k % 2 * most;
            self.fronts[s].update = update;
            self.fronts[s].work = update;
        }
        self.room += 2 * most;
        self.trunk = trunk.into_iter().map(number).collect();
        Some(())
    }

    /// Numbers the rows of the fronts. A subtree depends on the rows of its last front.
    fn number_rows(&mut self, symbolic: &SymbolicSupernodalCholesky<usize>) {
        let rows_of = |s: usize| {
            symbolic
                .supernode(s)
                .pattern()
                .iter()
                .map(|&row| number(row))
        };
        self.rows = (0..self.fronts.len()).flat_map(rows_of).collect();
        for tree in &mut self.subtrees {
            let fronts = &self.fronts[tree.fronts.clone()];
            let (first, last) = (&fronts[0], &fronts[fronts.len() - 1]);
            let above = &self.rows[last.places.clone()];
            tree.above = self.above.len()..self.above.len() + above.len();
            self.above.extend_from_slice(above);
            let above = &self.above[tree.above.clone()];
            let (start, own) = (number(tree.columns.start), number(tree.columns.len()));
            for row in &mut self.rows[first.places.start..last.places.end] {
                *row = match above.binary_search(row) {
                    Ok(place) => own + number(place),
                    Err(_) => *row - start,
                };
            }
            let room = tree.columns.len() + above.len() + most_rows(fronts.iter());
            tree.local = self.locals..self.locals + room;
            self.locals = tree.local.end;
        }
        let room = most_rows(self.trunk.iter().map(|&s| &self.fronts[s as usize]));
        self.trunk_scratch = self.locals..self.locals + room;
        self.locals = self.trunk_scratch.end;
    }

    /// Places the updates of a subtree, from the end of the room on, as on a stack: each is computed above
    /// the updates of its children, and then takes their place. Returns the height of the stack.
    fn stack(&mut self, fronts: Range<usize>) -> usize {
        let (mut top, mut most) = (self.room, self.room);
        for s in fronts {
            let first = self.children[self.fronts[s].children.clone()].first();
            let update = first.map_or(top, |&c| self.fronts[c as usize].update);
            let size = self.fronts[s].rows.pow(2);
            self.fronts[s].work = top;
            self.fronts[s].update = update;
            most = most.max(top + size);
            top = update + size;
        }
        most - self.room
    }
}

/// The most rows of some fronts.
fn most_rows<'a>(fronts: impl Iterator<Item = &'a Front>) -> usize {
    fronts.map(|front| front.rows).max().unwrap_or(0)
}

/// Where the members of each of `count` groups begin, and where the last ends, if they are sorted by group.
fn grouped(count: usize, groups: impl Iterator<Item = usize>) -> Vec<usize> {
    let mut first = vec![0; count + 1];
    for group in groups {
        first[group + 1] += 1;
    }
    for s in 0..count {
        first[s + 1] += first[s];
    }
    first
}

/// Numbers of fronts, rows and values are kept with 32 bits.
fn number(n: usize) -> u32 {
    u32::try_from(n).expect("a matrix with fewer than 2^32 values")
}
