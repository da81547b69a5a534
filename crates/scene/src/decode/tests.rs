//! Images: plain and Basis Universal KTX 2, and what is refused. (PNG, JPEG and WebP are tested with the glTF importer.)
//!
//! The Basis fixtures are made by Binomial's encoder 1.16 from a 5 × 3 image with texel (40 x, 80 y, 128, 200 + 10 x); the expected texels
//! are those of this decoder, which was compared bit for bit with another one (the crate `basisu`) when they were recorded.

use super::*;
use crate::{ImportLimits, Texels};

const ETC1S: &[u8] = include_bytes!("fixtures/etc1s.ktx2");
const UASTC: &[u8] = include_bytes!("fixtures/uastc.ktx2");
const UASTC_ZSTANDARD: &[u8] = include_bytes!("fixtures/uastc_zstandard.ktx2");

fn try_decode(bytes: &[u8], limits: ImportLimits) -> Result<TextureImage, SceneError> {
    let encoded = Encoded { file: "a.gltf", place: "image 0".into(), name: "sky".into(), bytes };
    decode(&encoded, &Budget::new(limits)).map(|decoded| decoded.image)
}

fn texels8(bytes: &[u8]) -> Vec<[u8; 4]> {
    match try_decode(bytes, ImportLimits::default()).unwrap_or_else(|error| panic!("{error}")).texels {
        Texels::Rgba8(texels) => texels,
        other => panic!("8 bits, not {other:?}"),
    }
}

/// A KTX 2 file with one level and no compression.
fn plain(vk_format: u32, width: u32, height: u32, level: &[u8]) -> Vec<u8> {
    let mut file = ktx2_container::MAGIC.to_vec();
    for word in [vk_format, 1, width, height, 0, 0, 1, 1, 0, 104, 28, 0, 0, 0, 0, 0, 0] {
        file.extend(word.to_le_bytes());
    }
    for word in [132u64, level.len() as u64, level.len() as u64] {
        file.extend(word.to_le_bytes());
    }
    // A data format descriptor without samples: its size, then a basic block of 24 bytes.
    for word in [28u32, 0, 2 | 24 << 16, 1 | 1 << 8 | 1 << 16, 0, 0, 0] {
        file.extend(word.to_le_bytes());
    }
    file.extend(level);
    file
}

#[test]
fn plain_texels_of_8_bits_get_missing_channels() {
    assert_eq!(texels8(&plain(9, 2, 1, &[7, 8])), [[7, 0, 0, 255], [8, 0, 0, 255]], "R8");
    assert_eq!(texels8(&plain(16, 1, 1, &[7, 8])), [[7, 8, 0, 255]], "R8G8");
    assert_eq!(texels8(&plain(23, 1, 2, &[1, 2, 3, 4, 5, 6])), [[1, 2, 3, 255], [4, 5, 6, 255]], "R8G8B8");
    assert_eq!(texels8(&plain(43, 1, 1, &[1, 2, 3, 4])), [[1, 2, 3, 4]], "R8G8B8A8 sRGB");
    assert_eq!(texels8(&plain(44, 1, 1, &[1, 2, 3, 4])), [[3, 2, 1, 4]], "B8G8R8A8");
}

#[test]
fn deeper_texels_keep_their_depth() {
    let image = try_decode(&plain(77, 1, 1, &[0x34, 0x12, 0xff, 0xff]), ImportLimits::default()).unwrap();
    assert!(matches!(&image.texels, Texels::Rgba16(t) if t[..] == [[0x1234, 0xffff, 0, 0xffff]]));
    let halves = [0x00, 0x3c, 0x00, 0xc0, 0x00, 0x7c]; // 1, −2, infinity
    let image = try_decode(&plain(90, 1, 1, &halves), ImportLimits::default()).unwrap();
    assert!(matches!(&image.texels, Texels::Rgba32F(t) if t[..] == [[1.0, -2.0, 0.0, 1.0]]), "{:?}", image.texels);
    let floats: Vec<u8> = [0.25f32, 0.5, 0.75, 1.0].iter().flat_map(|v| v.to_le_bytes()).collect();
    let image = try_decode(&plain(109, 1, 1, &floats), ImportLimits::default()).unwrap();
    assert!(matches!(&image.texels, Texels::Rgba32F(t) if t[..] == [[0.25, 0.5, 0.75, 1.0]]));
}

/// The red channels of the first row and the green ones of the first column.
fn cross(texels: &[[u8; 4]]) -> ([u8; 5], [u8; 3]) {
    assert_eq!(texels.len(), 15);
    (std::array::from_fn(|x| texels[x][0]), std::array::from_fn(|y| texels[5 * y][1]))
}

#[test]
fn etc1s_is_decoded_with_alpha() {
    let texels = texels8(ETC1S);
    assert_eq!(texels[..5], [[0, 9, 34, 197], [0, 9, 34, 209], [0, 9, 34, 219], [0, 9, 34, 231], [91, 33, 58, 240]]);
    assert_eq!(texels[13..], [[107, 148, 173, 231], [195, 137, 162, 240]]);
}

#[test]
fn uastc_is_decoded_with_and_without_zstandard() {
    assert_eq!(cross(&texels8(UASTC)), ([0, 39, 80, 119, 159], [0, 84, 171]));
    assert_eq!(cross(&texels8(UASTC_ZSTANDARD)), ([0, 39, 80, 119, 159], [0, 102, 152]));
    for texel in texels8(UASTC).chunks_exact(5).flatten() {
        assert!(texel[2].abs_diff(128) <= 3, "blue is 128 everywhere: {texel:?}");
    }
}

/// Bits of a block, least significant first.
fn block(fields: &[(u128, u32)]) -> [u8; 16] {
    let (mut bits, mut at) = (0, 0);
    for &(value, width) in fields {
        bits |= value << at;
        at += width;
    }
    bits.to_le_bytes()
}

#[test]
fn solid_uastc_blocks_have_one_colour() {
    let block = block(&[(0x17, 5), (10, 8), (20, 8), (30, 8), (40, 8)]);
    assert_eq!(uastc::decode_block(block), Some([[10, 20, 30, 40]; 16]));
}

/// Mode 1: end colours of 8 bits (0, 100, 255) and (255, 100, 0), weights of 2 bits: 0, 21, 43 and 64 of 64, the first without its high bit.
#[test]
fn uastc_texels_lie_between_their_end_colours() {
    let mut fields = vec![(0x35, 6), (0, 15), (0, 8), (255, 8), (100, 8), (100, 8), (255, 8), (0, 8), (1, 1)];
    fields.extend((1..16).map(|texel| (texel % 4, 2)));
    let texels = uastc::decode_block(block(&fields)).unwrap();
    let ramp = [[0, 100, 255, 255], [84, 100, 171, 255], [171, 100, 84, 255], [255, 100, 0, 255]];
    assert_eq!(texels[0], ramp[1]);
    for texel in 1..16 {
        assert_eq!(texels[texel], ramp[texel % 4], "texel {texel}");
    }
}

#[test]
fn bits_that_are_no_uastc_block_are_refused() {
    assert_eq!(uastc::decode_block(block(&[(0x45, 7)])), None, "the reserved mode");
    assert_eq!(uastc::decode_block(block(&[(0x03, 5), (0, 15), (11, 4)])), None, "a pattern that mode 3 does not have");
}

#[test]
fn every_truncation_is_refused() {
    for file in [ETC1S.to_vec(), UASTC.to_vec(), UASTC_ZSTANDARD.to_vec(), plain(37, 2, 2, &[9; 16])] {
        for length in 0..file.len() {
            let cut = try_decode(&file[..length], ImportLimits::default());
            assert!(cut.is_err(), "cut to {length} of {}", file.len());
        }
    }
}

#[test]
fn sizes_shapes_and_formats_are_checked() {
    let error = |bytes: &[u8]| try_decode(bytes, ImportLimits { bytes: 1 << 20, image_side: 1000 }).unwrap_err().to_string();
    assert_eq!(error(&plain(37, 0, 5, &[])), "`a.gltf`: image 0: the image has 0 × 5 px");
    assert!(error(&plain(37, 1001, 1, &[0; 4])).contains("an image side of 1001 exceeds the limit of 1000"));
    assert!(error(&plain(37, 1000, 1000, &[0; 4])).contains("a total of decoded bytes of 4000000 exceeds the limit of 1048576"));
    assert!(error(&plain(37, 2, 2, &[0; 12])).contains("the KTX 2 level has 12 bytes instead of 16"));
    assert!(error(&plain(145, 4, 4, &[0; 16])).contains("a KTX 2 file in the format BC7_UNORM_BLOCK) is not supported; convert it"));
    let mut cube = plain(37, 1, 1, &[0; 24]);
    cube[36] = 6;
    assert!(error(&cube).contains("cube map"), "{}", error(&cube));
    let mut large = ETC1S.to_vec();
    large[20..24].copy_from_slice(&900u32.to_le_bytes());
    assert!(error(&large).contains("the KTX 2 file is damaged: "), "{}", error(&large));
}

/// The file says that rows run upwards, and that red and green are exchanged.
#[test]
fn orientation_and_swizzle_are_applied() {
    let mut file = plain(23, 1, 2, &[1, 2, 3, 4, 5, 6]);
    let pairs = [b"\x12\0\0\0KTXorientation\0ru\0\0\0".as_slice(), b"\x10\0\0\0KTXswizzle\0grb1\0"].concat();
    let offset = file.len() as u32;
    file[56..60].copy_from_slice(&offset.to_le_bytes());
    file[60..64].copy_from_slice(&(pairs.len() as u32).to_le_bytes());
    file.extend(pairs);
    assert_eq!(texels8(&file), [[5, 4, 6, 255], [2, 1, 3, 255]]);
    file.pop();
    assert!(try_decode(&file, ImportLimits::default()).unwrap_err().to_string().contains("key/value data lies outside the file"));
}

#[test]
fn dropped_mip_levels_are_noted() {
    let note = |file: &[u8]| {
        let encoded = Encoded { file: "a.gltf", place: "image 0".into(), name: "sky".into(), bytes: file };
        decode(&encoded, &Budget::new(ImportLimits::default())).unwrap().note
    };
    let mut file = plain(37, 1, 1, &[9; 4]);
    assert_eq!(note(&file), None);
    file[40] = 2;
    assert_eq!(note(&file), Some(MIP_LEVELS));
}

/// A small file may declare a large image: it is refused by its pixels, whatever its sides, before memory is taken.
#[test]
fn images_of_too_many_pixels_are_refused() {
    let error = |file: &[u8]| try_decode(file, ImportLimits::default()).unwrap_err().to_string();
    let large = error(&plain(37, 16_384, 8193, &[]));
    assert_eq!(large, "`a.gltf`: image 0: a number of pixels of 134234112 exceeds the limit of 134217728; reduce it");
    assert!(error(&plain(37, 16_384, 8192, &[])).contains("bytes instead of 536870912"), "as many as that are allowed");
    let mut jpeg = std::io::Cursor::new(Vec::new());
    image::GrayImage::new(512, 512).write_to(&mut jpeg, image::ImageFormat::Jpeg).unwrap();
    assert!(try_decode(jpeg.get_ref(), ImportLimits::default()).is_ok());
    assert!(error(&jpeg.get_ref()[..511]).contains("the JPEG is cut short: 511 bytes cannot hold 512 × 512 px"));
}

#[test]
fn mutated_images_never_panic() {
    let limits = ImportLimits { bytes: 1 << 22, image_side: 512 };
    let mut state = 0x2545_f491_4f6c_dd1du64;
    let mut random = |below: usize| {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state % below as u64) as usize
    };
    let mut decoded = 0;
    for file in [ETC1S.to_vec(), UASTC.to_vec(), UASTC_ZSTANDARD.to_vec(), plain(37, 2, 2, &[9; 16])] {
        for _ in 0..2000 {
            let mut file = file.clone();
            for _ in 0..=random(3) {
                let at = 12 + random(file.len() - 12);
                file[at] = random(256) as u8;
            }
            decoded += usize::from(try_decode(&file, limits).is_ok());
        }
    }
    assert!((100..7900).contains(&decoded), "{decoded} of 8000 decoded: the mutations should give both");
}
