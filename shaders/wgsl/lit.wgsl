// Lit surfaces without textures: `L = emission + reflectance × H / π`, with irradiance between vertices (Gouraud 1971) or
// that of the element. Interpolation is perspective-correct.

@fragment
fn opaque(in: Fragment) -> @location(0) vec4<f32> {
    let surface = surface_at(materials[in.material], in, NO_TEXELS);
    if surface.is_hole {
        discard;
    }
    return exposed(own_radiance(surface, in));
}

// Of what lets light through: its own radiance, which is added,
@fragment
fn own(in: Fragment) -> @location(0) vec4<f32> {
    let surface = surface_at(materials[in.material], in, NO_TEXELS);
    return exposed(own_radiance(surface, in));
}

// after what is behind it was multiplied by its transmittance.
@fragment
fn through(in: Fragment) -> @location(0) vec4<f32> {
    return vec4(surface_at(materials[in.material], in, NO_TEXELS).transmittance, 1.0);
}

fn own_radiance(surface: Surface, in: Fragment) -> vec3<f32> {
    return surface.emission + surface.reflectance * solved_light(in) / PI;
}
