// shared/display.wgsl: from exposed light to what a display shows; the one tone map.
// Needs: shared/frame.wgsl. Linear in, linear out: the target is an sRGB texture and encodes by itself.
// Source of the curve: K. Narkowicz, ACES filmic tone mapping curve, 2016.

fn display(light: vec3<f32>) -> vec3<f32> {
    let x = light * frame.exposure;
    return clamp((x * (2.51 * x + 0.03)) / (x * (2.43 * x + 0.59) + 0.14), vec3<f32>(0.0), vec3<f32>(1.0));
}

// Half a step of an 8-bit sRGB target, of alternating sign over a fine fixed pattern, so that a smooth gradient shows
// no bands. Pattern: J. Jimenez, Next generation post processing in Call of Duty, 2014 (interleaved gradient noise).
fn dither(colour: vec3<f32>, pixel: vec2<f32>) -> vec3<f32> {
    let noise = fract(52.9829189 * fract(dot(pixel, vec2<f32>(0.06711056, 0.00583715)))) - 0.5;
    // d(linear) / d(sRGB) is close to 2 sqrt(linear); green stands for all three.
    return colour + sqrt(colour.g) * (noise * 2.3 / 255.0);
}
