//! A small encoder of meshopt streams, for tests: plain searches, no care for size or time.

#![allow(dead_code)]

/// How numbers of a channel are made, as the mode byte of version 1 has it: 0 bytes, 1 words, 2 + 16 n turned by n bits.
pub type Channel = u8;

const GROUP: usize = 16;

fn zigzag(difference: u32, bits: u32) -> u32 {
    let difference = (difference << (32 - bits)) as i32 >> (32 - bits);
    ((difference << 1) ^ (difference >> 31)) as u32
}

/// Encodes elements of `stride` bytes. Version 0 knows channels of bytes alone.
pub fn attributes(version: u8, bytes: &[u8], stride: usize, channel: Channel) -> Vec<u8> {
    let channel = if version == 0 { 0 } else { channel };
    let mut stream = vec![0xa0 | version];
    let block = (8192 / stride / GROUP * GROUP).min(256);
    let mut last = bytes[..stride].to_vec();
    for block in bytes.chunks(block * stride) {
        let mut planes: Vec<Vec<u8>> = vec![Vec::new(); stride];
        for element in block.chunks_exact(stride) {
            for c in (0..stride).step_by(4) {
                let numbers = numbers(&element[c..c + 4], &last[c..c + 4], channel);
                (0..4).for_each(|i| planes[c + i].push(numbers[i]));
            }
            last.copy_from_slice(element);
        }
        let coded: Vec<(u8, Vec<u8>)> = planes.iter().map(|plane| coded(version, plane)).collect();
        if version == 1 {
            for four in coded.chunks_exact(4) {
                stream.push(four.iter().enumerate().fold(0, |byte, (i, plane)| byte | plane.0 << (2 * i)));
            }
        }
        coded.iter().for_each(|plane| stream.extend_from_slice(&plane.1));
    }
    let mut tail = bytes[..stride].to_vec();
    if version == 1 {
        tail.resize(stride + stride / 4, channel);
    }
    let least: usize = if version == 1 { 24 } else { 32 };
    stream.resize(stream.len() + least.saturating_sub(tail.len()), 0);
    stream.extend_from_slice(&tail);
    stream
}

fn numbers(element: &[u8], last: &[u8], channel: Channel) -> [u8; 4] {
    let word = |bytes: &[u8]| u32::from_le_bytes(bytes.try_into().unwrap());
    let (new, old) = (word(element), word(last));
    match channel & 15 {
        0 => std::array::from_fn(|i| zigzag(element[i].wrapping_sub(last[i]).into(), 8) as u8),
        1 => {
            let half = |shift: u32| zigzag((new >> shift).wrapping_sub(old >> shift) & 0xffff, 16) & 0xffff;
            (half(0) | half(16) << 16).to_le_bytes()
        }
        _ => (new ^ old).rotate_left((channel >> 4).into()).to_le_bytes(),
    }
}

/// Encodes a plane by the shortest control: its number, and the bytes.
fn coded(version: u8, plane: &[u8]) -> (u8, Vec<u8>) {
    if version == 0 {
        return (0, groups(plane, [0, 2, 4, 8]));
    }
    if plane.iter().all(|&x| x == 0) {
        return (2, Vec::new());
    }
    let all = [(0, groups(plane, [0, 1, 2, 4])), (1, groups(plane, [1, 2, 4, 8])), (3, plane.to_vec())];
    all.into_iter().min_by_key(|coded| coded.1.len()).unwrap()
}

fn groups(plane: &[u8], widths: [usize; 4]) -> Vec<u8> {
    let mut plane = plane.to_vec();
    plane.resize(plane.len().next_multiple_of(GROUP), 0);
    let mut header = vec![0; (plane.len() / GROUP).div_ceil(4)];
    let mut content = Vec::new();
    for (g, group) in plane.chunks_exact(GROUP).enumerate() {
        let all = widths.map(|width| packed(group, width));
        let best = (0..4).filter(|&i| all[i].is_some()).min_by_key(|&i| all[i].as_ref().unwrap().len());
        header[g / 4] |= (best.unwrap() as u8) << (2 * (g % 4));
        content.extend_from_slice(all[best.unwrap()].as_ref().unwrap());
    }
    header.extend(content);
    header
}

fn packed(group: &[u8], width: usize) -> Option<Vec<u8>> {
    match width {
        0 => return group.iter().all(|&x| x == 0).then(Vec::new),
        8 => return Some(group.to_vec()),
        _ => {}
    }
    let (each, all) = (8 / width, (1_u16 << width) as u8 - 1);
    let mut bytes = vec![0; 2 * width];
    for (i, &number) in group.iter().enumerate() {
        let place = if width == 1 { i % each } else { each - 1 - i % each };
        bytes[i / each] |= number.min(all) << (width * place);
    }
    bytes.extend(group.iter().filter(|&&number| number >= all));
    Some(bytes)
}

fn number(mut value: u32, to: &mut Vec<u8>) {
    while value >= 0x80 {
        to.push(value as u8 | 0x80);
        value >>= 7;
    }
    to.push(value as u8);
}

/// Encodes a list of triangles, each with its corners in this order.
pub fn triangles(indices: &[u32]) -> Vec<u8> {
    const TABLE: [u8; 16] = [0, 0x01, 0x10, 0x11, 0x12, 0x21, 0x20, 0x02, 0x30, 0x03, 0, 0, 0, 0, 0, 0];
    let (mut edges, mut vertices) = (Vec::<[u32; 2]>::new(), Vec::<u32>::new());
    let (mut next, mut last) = (0_u32, 0_u32);
    let (mut codes, mut data) = (vec![0xe1], Vec::new());
    let explicit = |index: u32, last: &mut u32, data: &mut Vec<u8>| {
        number(zigzag(index.wrapping_sub(*last), 32), data);
        *last = index;
    };
    for triangle in indices.chunks_exact(3) {
        let [a, b, c] = [triangle[0], triangle[1], triangle[2]];
        let back = edges.iter().rev().take(15).position(|edge| *edge == [a, b]);
        if let Some(back) = back {
            let of_vertex = vertices.iter().rev().take(13).skip(1).position(|&v| v == c);
            let corner = match of_vertex {
                _ if c == next => 0,
                Some(place) => place + 1,
                None if c == last.wrapping_sub(1) => 13,
                None if c == last.wrapping_add(1) => 14,
                None => 15,
            };
            codes.push((back << 4 | corner) as u8);
            match corner {
                0 => next += 1,
                13 | 14 => last = c,
                15 => explicit(c, &mut last, &mut data),
                _ => {}
            }
            edges.extend([[c, b], [a, c]]);
            if corner == 0 || corner > 12 {
                vertices.push(c);
            }
            continue;
        }
        if [a, b, c] == [0, 1, 2] && next > 2 {
            // A new beginning.
            codes.push(0xfe);
            data.push(0);
            next = 3;
            edges.extend([[b, a], [c, b], [a, c]]);
            vertices.extend([a, b, c]);
            continue;
        }
        let first = if a == next { 0 } else { 15 };
        next += u32::from(first == 0);
        let mut corner = |v: u32| {
            if v == next {
                next += 1;
                return 0;
            }
            vertices.iter().rev().take(14).position(|&other| other == v).map_or(15, |place| place as u8 + 1)
        };
        let mut others = [corner(b), corner(c)];
        if first == 15 && others == [0, 0] {
            // Would mean a new beginning.
            next -= 1;
            others[1] = 15;
        }
        let byte = others[0] << 4 | others[1];
        let place = TABLE[..14].iter().position(|&entry| entry == byte);
        if let (0, Some(place)) = (first, place) {
            codes.push(0xf0 | place as u8);
        } else {
            codes.push(if first == 0 { 0xfe } else { 0xff });
            data.push(byte);
        }
        for (bits, v) in [(first, a), (others[0], b), (others[1], c)] {
            if bits == 15 {
                explicit(v, &mut last, &mut data);
            }
        }
        edges.extend([[b, a], [c, b], [a, c]]);
        vertices.push(a);
        vertices.extend([(others[0], b), (others[1], c)].iter().filter(|v| v.0 % 15 == 0).map(|v| v.1));
    }
    codes.extend(data);
    codes.extend(TABLE);
    codes
}

/// Encodes indices of any kind, below 2^30.
pub fn indices(indices: &[u32]) -> Vec<u8> {
    let mut stream = vec![0xd1];
    let mut last = [0_u32; 2];
    for &index in indices {
        let sequence = usize::from(index.abs_diff(last[1]) < index.abs_diff(last[0]));
        let difference = index.wrapping_sub(last[sequence]);
        number(zigzag(difference, 32) << 1 | sequence as u32, &mut stream);
        last[sequence] = index;
    }
    stream.extend([0; 4]);
    stream
}
