// Which element each pixel shows: its number plus one, 0 where nothing is.

@fragment
fn pick(in: Fragment) -> @location(0) u32 {
    return in.element + 1u;
}
