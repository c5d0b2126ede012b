// The colour that the iridescent sphere would have under white light, for every pixel; `model.rs` has the formulas in Rust.
//
// Only operations that Vulkan rounds to a few units in the last place are used: WGSL lets `cos` and `pow` err by 5e-4 and more.

struct Scene {
    light_direction: vec3<f32>,
    half_pixel: f32,
    light: vec3<f32>,
    width: f32,
    indices: vec3<f32>,
    thickness: f32,
    wavelengths: vec3<f32>,
    thickness_range: f32,
    base: vec3<f32>,
    tilt: f32,
    diffuse: f32,
    specular: f32,
}

@group(0) @binding(0) var<uniform> scene: Scene;

// cos(2πt) = 1 - 2 sin²(πr), r = t - round(t), by the series of the sine.
fn cosine(turns: f32) -> f32 {
    let angle = 3.14159265 * (turns - floor(turns + 0.5));
    let s = angle * angle;
    let sine = angle
        * (1.0 + s * (-1.6666667e-1 + s * (8.3333333e-3 + s * (-1.9841270e-4 + s * (2.7557319e-6 - s * 2.5052108e-8)))));
    return 1.0 - 2.0 * sine * sine;
}

fn power_32(x: f32) -> f32 {
    let x2 = x * x;
    let x4 = x2 * x2;
    let x8 = x4 * x4;
    let x16 = x8 * x8;
    return x16 * x16;
}

// The 32nd power of the cosine between unit vectors, 0 where that is negative. The cosine is computed as 1 - |a - b|²/2: near 1,
// where the power magnifies errors, it has smaller ones than a · b.
fn lobe(a: vec3<f32>, b: vec3<f32>) -> f32 {
    let difference = a - b;
    return power_32(max(1.0 - 0.5 * dot(difference, difference), 0.0));
}

// The part reflected by a layer's surface (Schlick 1994).
fn fresnel(index: f32, cosine_outside: f32) -> f32 {
    let normal = (index - 1.0) * (index - 1.0) / ((index + 1.0) * (index + 1.0));
    let m = 1.0 - cosine_outside;
    let m2 = m * m;
    return normal + (1.0 - normal) * (m2 * m2 * m);
}

// The direction opposite to `towards`, refracted into the layer; `cosines` are those outside and inside.
fn refracted(towards: vec3<f32>, normal: vec3<f32>, index: f32, cosines: vec2<f32>) -> vec3<f32> {
    return (cosines.x / index - cosines.y) * normal - towards / index;
}

fn cosine_inside(index: f32, cosine_outside: f32) -> f32 {
    return sqrt(1.0 - (1.0 - cosine_outside * cosine_outside) / (index * index));
}

// Two beams: one from the surface of the layer, one from the base through the layer.
fn specular_term(normal: vec3<f32>, base_normal: vec3<f32>, index: f32, thickness_in_waves: f32) -> f32 {
    let to_view = vec3<f32>(0.0, 0.0, 1.0);
    let to_light = scene.light_direction;
    let at_light = vec2<f32>(dot(normal, to_light), cosine_inside(index, dot(normal, to_light)));
    let at_view = vec2<f32>(normal.z, cosine_inside(index, normal.z));
    let reflected = fresnel(index, at_light.x);
    let transmitted = (1.0 - reflected) * (1.0 - fresnel(index, at_view.x));

    let mirrored = 2.0 * at_light.x * normal - to_light;
    let surface = sqrt(reflected) * lobe(mirrored, to_view);

    let down = refracted(to_light, normal, index, at_light);
    let seen = refracted(to_view, normal, index, at_view);
    let up = down - 2.0 * dot(down, base_normal) * base_normal;
    var base = sqrt(transmitted) * lobe(up, -seen);
    if dot(down, base_normal) >= 0.0 || dot(seen, base_normal) >= 0.0 {
        base = 0.0;
    }
    let phase = cosine(index * thickness_in_waves * (at_light.y + at_view.y));
    return surface * surface + base * base + 2.0 * surface * base * phase;
}

// The mean over all directions: 80/21 n/(n+1)² of the light passes the surface.
fn diffuse_term(index: f32, thickness_in_waves: f32) -> f32 {
    let passed = 3.8095238 * index / ((index + 1.0) * (index + 1.0));
    return 0.5 + cosine(2.0 * index * thickness_in_waves) * sqrt(passed * (1.0 - passed));
}

fn component(normal: vec3<f32>, base_normal: vec3<f32>, index: f32, thickness_in_waves: f32, base: f32) -> f32 {
    let diffuse = scene.diffuse * base * diffuse_term(index, thickness_in_waves);
    return diffuse + scene.specular * specular_term(normal, base_normal, index, thickness_in_waves);
}

// The position is that of the pixel's centre, in pixels from the upper left; outside the sphere the colour is black.
fn reflected_colour(position: vec2<f32>) -> vec3<f32> {
    let x = scene.half_pixel * (2.0 * position.x - scene.width);
    let y = scene.half_pixel * (scene.width - 2.0 * position.y);
    let square = x * x + y * y;
    if square >= 1.0 {
        return vec3<f32>(0.0);
    }
    let normal = vec3<f32>(x, y, sqrt(1.0 - square));
    let lit = dot(normal, scene.light_direction);
    if lit <= 0.0 {
        return vec3<f32>(0.0);
    }
    let tilt = scene.tilt * vec3<f32>(cosine(0.2 * x + 0.1 * y + 0.05), cosine(0.2 * y - 0.1 * x + 0.45), 0.0);
    let tilted = normal + tilt;
    let base_normal = tilted / sqrt(dot(tilted, tilted));
    let thickness = scene.thickness + scene.thickness_range * cosine(0.3 * x - 0.4 * y + 0.1);
    let waves = vec3<f32>(thickness) / scene.wavelengths;
    return lit * vec3<f32>(
        component(normal, base_normal, scene.indices.x, waves.x, scene.base.x),
        component(normal, base_normal, scene.indices.y, waves.y, scene.base.y),
        component(normal, base_normal, scene.indices.z, waves.z, scene.base.z),
    );
}

@fragment
fn shade(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    return vec4<f32>(product(scene.light, reflected_colour(position.xy)), 1.0);
}
