// Lit surfaces with textures and a relief, which turns normals and with them what light arrives.

fn bumped_radiance(surface: Surface, in: Fragment, footprint: Footprint) -> vec3<f32> {
    let flat_side = flat_normal(in);
    let bumped = bumped_at(in, footprint, flat_side);
    return surface.emission + surface.reflectance * tilted_light(in, flat_side, bumped.normal) / PI;
}

@fragment
fn masked(in: Fragment) -> @location(0) vec4<f32> {
    let footprint = footprint_of(in);
    let surface = surface_at(in, texels_at(footprint));
    let radiance = bumped_radiance(surface, in, footprint);
    if surface.is_hole {
        discard;
    }
    return exposed(radiance);
}

@fragment
fn own(in: Fragment) -> @location(0) vec4<f32> {
    let footprint = footprint_of(in);
    let surface = surface_at(in, texels_at(footprint));
    return exposed(bumped_radiance(surface, in, footprint));
}

@fragment
fn through(in: Fragment) -> @location(0) vec4<f32> {
    let footprint = footprint_of(in);
    return vec4(surface_at(in, texels_at(footprint)).transmittance, 1.0);
}
