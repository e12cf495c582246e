// Lit surfaces with textures and a relief, which turns normals and with them what light arrives.

fn bumped_radiance(surface: Surface, in: Fragment, material: Material, footprint: Footprint) -> vec3<f32> {
    let flat_side = flat_normal(in);
    let bumped = bumped_at(material, in, footprint, flat_side);
    return surface.emission + surface.reflectance * tilted_light(in, flat_side, bumped.normal) / PI;
}

@fragment
fn masked(in: Fragment) -> @location(0) vec4<f32> {
    let footprint = footprint_of(in);
    let material = materials[in.material];
    let surface = surface_at(material, in, texels_at(material, footprint));
    let radiance = bumped_radiance(surface, in, material, footprint);
    if surface.is_hole {
        discard;
    }
    return exposed(radiance);
}

@fragment
fn own(in: Fragment) -> @location(0) vec4<f32> {
    let footprint = footprint_of(in);
    let material = materials[in.material];
    let surface = surface_at(material, in, texels_at(material, footprint));
    return exposed(bumped_radiance(surface, in, material, footprint));
}

@fragment
fn through(in: Fragment) -> @location(0) vec4<f32> {
    let footprint = footprint_of(in);
    let material = materials[in.material];
    return vec4(surface_at(material, in, texels_at(material, footprint)).transmittance, 1.0);
}
