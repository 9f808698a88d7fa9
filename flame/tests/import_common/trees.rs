//! Trees of random shape, in bytes and as what must be read from them.

use std::collections::BTreeMap;

use half::f16;

use super::Random;
use super::vdb::{ACTIVE_MASK, Form, packed};

/// As many numbers as the type has, then zeros.
pub type Value = [f32; 3];

/// Contents of a tree.
#[derive(Debug, Default)]
pub struct Written {
    pub background: Value,
    /// By origin: all values.
    pub leaves: BTreeMap<[i32; 3], Vec<Value>>,
    /// Other than the background: by the edge's logarithm and the origin.
    pub tiles: BTreeMap<(u32, [i32; 3]), Value>,
    /// Number of nodes with each flag.
    pub flags: [usize; 7],
}

pub fn components(kind: &str) -> usize {
    if kind.starts_with("vec3") { 3 } else { 1 }
}

fn has_half_form(kind: &str) -> bool {
    matches!(kind, "float" | "double" | "vec3s" | "vec3d")
}

/// Appends one value in full width, or in half.
fn encode(kind: &str, half: bool, value: &Value, bytes: &mut Vec<u8>) {
    for x in &value[..components(kind)] {
        match kind {
            _ if half => bytes.extend(f16::from_f32(*x).to_le_bytes()),
            "half" => bytes.extend(f16::from_f32(*x).to_le_bytes()),
            "float" | "vec3s" => bytes.extend(x.to_le_bytes()),
            "double" | "vec3d" => bytes.extend(f64::from(*x).to_le_bytes()),
            "int32" => bytes.extend((*x as i32).to_le_bytes()),
            "bool" => bytes.push(*x as u8),
            _ => panic!("{kind}"),
        }
    }
}

struct Grower<'a> {
    form: Form,
    kind: &'static str,
    random: &'a mut Random,
    written: Written,
}

/// Topology, leaves and truth.
pub fn random_tree(form: Form, kind: &'static str, random: &mut Random) -> (Vec<u8>, Vec<u8>, Written) {
    let mut grower = Grower { form, kind, random, written: Written::default() };
    grower.written.background = if grower.random.chance(0.5) { [0.0; 3] } else { grower.value() };
    let (topology, leaves) = grower.root();
    (topology, leaves, grower.written)
}

/// Topology and leaves of a tree with `count` leaves, all within 64 voxels of the origin; zero elsewhere. Values are smooth enough for
/// a surface.
pub fn small_tree(form: Form, kind: &'static str, count: usize, random: &mut Random) -> (Vec<u8>, Vec<u8>) {
    let half = form.half && has_half_form(kind);
    let branch = |slots: usize, children: &[usize], random: &mut Random| {
        let mask: Vec<bool> = (0..slots).map(|slot| children.contains(&slot)).collect();
        let mut zeros = vec![];
        (0..slots).for_each(|_| encode(kind, half, &[0.0; 3], &mut zeros));
        let values = packed_array(&zeros, form.compression, random);
        [mask_bytes(&mask), vec![0; slots / 8], vec![6], values].concat()
    };
    let mut slots: Vec<usize> = (0..count)
        .map(|_| [random.below(8), random.below(8), random.below(8)])
        .map(|[x, y, z]| (x << 8) | (y << 4) | z)
        .collect();
    slots.sort_unstable();
    slots.dedup();
    let mut topology = 1i32.to_le_bytes().to_vec();
    encode(kind, false, &[0.0; 3], &mut topology);
    topology.extend([0u32.to_le_bytes(), 1u32.to_le_bytes()].concat());
    topology.extend(origin_bytes([0; 3]));
    topology.extend(branch(1 << 15, &[0], random));
    topology.extend(branch(1 << 12, &slots, random));
    let mut leaves = vec![];
    for _ in &slots {
        topology.extend([0xFF; 64]);
        let (mut numbers, waves) = (vec![], [(); 3].map(|()| random.below(9) as f32 * 0.1));
        for voxel in 0..512 {
            let at = [voxel >> 6, voxel >> 3 & 7, voxel & 7].map(|i| i as f32);
            let value = [0, 1, 2].map(|n| 4.0 * (waves[n] * at[n] + waves[(n + 1) % 3] * at[(n + 1) % 3]).sin() + 2.0);
            encode(kind, half, &value, &mut numbers);
        }
        leaves.extend([[0xFF; 64].to_vec(), vec![6], packed_array(&numbers, form.compression, random)].concat());
    }
    (topology, leaves)
}

fn mask_bytes(mask: &[bool]) -> Vec<u8> {
    mask.chunks(8).map(|bits| bits.iter().enumerate().map(|(i, bit)| u8::from(*bit) << i).sum()).collect()
}

fn origin_bytes(origin: [i32; 3]) -> Vec<u8> {
    origin.into_iter().flat_map(i32::to_le_bytes).collect()
}

impl Grower<'_> {
    /// Exact in every type.
    fn value(&mut self) -> Value {
        let number = |random: &mut Random| match self.kind {
            "bool" => random.below(2) as f32,
            "int32" => random.below(200) as f32 - 100.0,
            _ => (random.below(128) as f32 - 64.0) * 0.25,
        };
        let mut value = [0.0; 3];
        value[..components(self.kind)].iter_mut().for_each(|x| *x = number(self.random));
        value
    }

    fn negative(&self) -> Value {
        self.written.background.map(|x| if self.kind == "bool" { 1.0 - x } else { -x })
    }

    fn root(&mut self) -> (Vec<u8>, Vec<u8>) {
        let mut origins: Vec<[i32; 3]> =
            (0..4).map(|_| [0; 3].map(|_: i32| (self.random.below(4) as i32 - 2) * 4096)).collect();
        origins.sort();
        origins.dedup();
        let (tiles, children): (Vec<_>, Vec<_>) = origins.into_iter().partition(|_| self.random.chance(0.4));
        let mut topology = 1i32.to_le_bytes().to_vec();
        encode(self.kind, false, &self.written.background, &mut topology);
        topology.extend((tiles.len() as u32).to_le_bytes());
        topology.extend((children.len() as u32).to_le_bytes());
        for origin in tiles {
            let value = self.value();
            topology.extend(origin_bytes(origin));
            encode(self.kind, false, &value, &mut topology);
            topology.push(self.random.below(2) as u8);
            self.tile(12, origin, value);
        }
        let mut leaves = vec![];
        for origin in children {
            topology.extend(origin_bytes(origin));
            self.branch(0, origin, &mut topology, &mut leaves);
        }
        (topology, leaves)
    }

    fn tile(&mut self, log2: u32, origin: [i32; 3], value: Value) {
        if value != self.written.background {
            self.written.tiles.insert((log2, origin), value);
        }
    }

    fn branch(&mut self, level: usize, origin: [i32; 3], topology: &mut Vec<u8>, leaves: &mut Vec<u8>) {
        let (log2, slot_log2, most_children) = [(5, 7, 3), (4, 3, 7)][level];
        let slots = 1usize << (3 * log2);
        let mut children = vec![false; slots];
        for _ in 0..self.random.below(most_children) {
            children[self.random.below(slots)] = true;
        }
        let share = self.random.pick(&[0.0, 0.001, 0.001, 0.2]);
        let active: Vec<bool> = children.iter().map(|child| !child && self.random.chance(share)).collect();
        let values = self.node_values(&active, &children);
        topology.extend(mask_bytes(&children));
        topology.extend(mask_bytes(&active));
        topology.extend(values.1);
        for (slot, is_child) in children.into_iter().enumerate() {
            let m = (1 << log2) - 1;
            let step = [slot >> (2 * log2), slot >> log2 & m, slot & m].map(|i| (i as i32) << slot_log2);
            let slot_origin = [0, 1, 2].map(|axis| origin[axis] + step[axis]);
            if !is_child {
                self.tile(slot_log2, slot_origin, values.0[slot]);
            } else if level == 0 {
                self.branch(1, slot_origin, topology, leaves);
            } else {
                self.leaf(slot_origin, topology, leaves);
            }
        }
    }

    fn leaf(&mut self, origin: [i32; 3], topology: &mut Vec<u8>, leaves: &mut Vec<u8>) {
        let share = self.random.pick(&[0.0, 0.1, 0.5, 0.9, 1.0]);
        let active: Vec<bool> = (0..512).map(|_| self.random.chance(share)).collect();
        topology.extend(mask_bytes(&active));
        leaves.extend(mask_bytes(&active));
        if self.kind == "bool" {
            let values: Vec<bool> = (0..512).map(|_| self.random.chance(0.5)).collect();
            leaves.extend(origin_bytes(origin));
            leaves.extend(mask_bytes(&values));
            let values = values.into_iter().map(|value| [f32::from(u8::from(value)), 0.0, 0.0]).collect();
            self.written.leaves.insert(origin, values);
            return;
        }
        if self.form.version < 222 {
            leaves.extend(origin_bytes(origin));
            leaves.push(1);
        }
        let (values, bytes) = self.node_values(&active, &[false; 512]);
        leaves.extend(bytes);
        self.written.leaves.insert(origin, values);
    }

    /// Values of a node's slots, and how they are stored. The flag is drawn; what is inactive follows from it.
    fn node_values(&mut self, active: &[bool], children: &[bool]) -> (Vec<Value>, Vec<u8>) {
        let is_old = self.form.version < 222;
        // What makes a tile of every slot of a large branch is rarer there.
        let flags: &[usize] =
            if active.len() > 4096 { &[0, 0, 0, 0, 1, 2, 3, 4, 5, 6, 6, 6] } else { &[0, 1, 2, 3, 4, 5, 6] };
        let flag = if is_old { 6 } else { self.random.pick(flags) };
        let (background, negative) = (self.written.background, self.negative());
        let (a, b) = (self.value(), self.value());
        let palette = match flag {
            0 => [background, background],
            1 => [negative, negative],
            2 => [a, a],
            3 => [negative, background],
            4 => [a, background],
            _ => [a, b],
        };
        let selection: Vec<bool> = active.iter().map(|active| !active && self.random.chance(0.5)).collect();
        // Without the mask what is stored counts, and the rest of the flag is read over.
        let masked = self.form.compression & ACTIVE_MASK != 0 && flag != 6 && !is_old;
        let share = if children.len() > 512 { 0.02 } else { 1.0 };
        let mut values = vec![];
        for (slot, active) in active.iter().enumerate() {
            // What need not follow the flag is background in most slots of a branch: there are many.
            let free = if *active || (!masked && self.random.chance(share)) {
                Some(self.value())
            } else if !masked {
                Some(self.written.background)
            } else {
                None
            };
            values.push(if let Some(free) = free { free } else { palette[usize::from(selection[slot])] });
        }
        let mut bytes = if is_old { vec![] } else { vec![flag as u8] };
        match flag {
            2 | 4 => encode(self.kind, false, &a, &mut bytes),
            5 => [a, b].iter().for_each(|value| encode(self.kind, false, value, &mut bytes)),
            _ => {}
        }
        if matches!(flag, 3..=5) {
            bytes.extend(mask_bytes(&selection));
        }
        self.written.flags[flag] += 1;
        let half = self.form.half && has_half_form(self.kind);
        let is_stored = |slot: &usize| if masked { active[*slot] } else { !(is_old && children[*slot]) };
        let stored: Vec<usize> = (0..values.len()).filter(is_stored).collect();
        let mut array = vec![];
        stored.iter().for_each(|slot| encode(self.kind, half, &values[*slot], &mut array));
        // An array of no halves leaves no trace.
        if !(half && stored.is_empty()) {
            bytes.extend(packed_array(&array, self.form.compression, self.random));
        }
        (values, bytes)
    }
}

/// An array, also one of nothing.
fn packed_array(array: &[u8], compression: u32, random: &mut Random) -> Vec<u8> {
    if !array.is_empty() || compression & 5 == 0 {
        return packed(array, compression, random);
    }
    if compression & 4 != 0 && random.chance(0.5) {
        let empty = [2, 1, 0x33, 4, 0, 0, 0, 0, 1, 0, 0, 0, 16, 0, 0, 0];
        return [&16i64.to_le_bytes()[..], &empty].concat();
    }
    0i64.to_le_bytes().to_vec()
}
