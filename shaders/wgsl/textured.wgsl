// Lit surfaces with textures: base colour, metallic share, emission and transmission are multiplied by them.

fn textured_surface(in: Fragment) -> Surface {
    return surface_at(in, texels_at(footprint_of(in)));
}

fn own_radiance(surface: Surface, in: Fragment) -> vec3<f32> {
    return surface.emission + surface.reflectance * solved_light(in) / PI;
}

@fragment
fn own(in: Fragment) -> @location(0) vec4<f32> {
    return exposed(own_radiance(textured_surface(in), in));
}

@fragment
fn masked(in: Fragment) -> @location(0) vec4<f32> {
    let surface = textured_surface(in);
    if surface.is_hole {
        discard;
    }
    return exposed(own_radiance(surface, in));
}

@fragment
fn through(in: Fragment) -> @location(0) vec4<f32> {
    return vec4(textured_surface(in).transmittance, 1.0);
}
