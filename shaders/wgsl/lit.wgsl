// Lit surfaces without textures: `L = emission + reflectance × H / π`, with irradiance between vertices (Gouraud 1971) or
// that of the element. Interpolation is perspective-correct.

// Of what hides, and of what lets light through, where it is added.
@fragment
fn own(in: Fragment) -> @location(0) vec4<f32> {
    let surface = surface_at(in, NO_TEXELS);
    return exposed(own_radiance(surface, in));
}

// Of what has holes. Stages that may discard look at depth late, so only masks have this one.
@fragment
fn masked(in: Fragment) -> @location(0) vec4<f32> {
    let surface = surface_at(in, NO_TEXELS);
    if surface.is_hole {
        discard;
    }
    return exposed(own_radiance(surface, in));
}

// What is behind is multiplied by this first.
@fragment
fn through(in: Fragment) -> @location(0) vec4<f32> {
    return vec4(surface_at(in, NO_TEXELS).transmittance, 1.0);
}

fn own_radiance(surface: Surface, in: Fragment) -> vec3<f32> {
    return surface.emission + surface.reflectance * solved_light(in) / PI;
}
