/* shaders.c - the GLSL sources.
 *
 * Solid things are drawn in two steps. The passes write what is seen at each sample: its colour (linear, alpha
 * = gloss), its normal towards the eye, what it is (`kind`, below) and its depth. The final pass lights it.
 * All positions count from the eye, so that single precision is enough wherever the scene lies.
 * kind: 0 background; 1..511 a bone; 512..1023 a muscle; 1024 a fiber; the first two negative, or -1024 for
 * fat, in a section. */
#include "render/shaders.h"

#include <stddef.h>

/* clang-format off */
static const char version[] =
    "#version 330 core\n";

/* What all vertex shaders know: place -> clip space of the tile, and the turn into the view's axes. Vertices count
 * from the scene's origin, places from the eye: u_shift is the origin's. */
static const char frame[] =
    "uniform mat4 u_clip;\n"
    "uniform mat3 u_turn;\n"
    "uniform vec3 u_shift;\n"
    "uniform vec4 u_plane;\n"
    "invariant gl_Position;\n";

/* What all solid passes write. */
static const char solid_out[] =
    "layout(location = 0) out vec4 o_color;\n"
    "layout(location = 1) out vec4 o_shape;\n"
    "uniform mat3 u_turn;\n"
    "uniform vec4 u_plane;\n";

/* a_tendon: above 0 where the muscle is tendon; between vertices all are linear, as in the tet. */
static const char muscle_vs[] =
    "layout(location = 0) in vec3 a_place;\n"
    "layout(location = 1) in vec3 a_normal;\n"
    "layout(location = 2) in float a_kind;\n"
    "layout(location = 3) in vec4 a_color;\n"
    "layout(location = 4) in float a_tendon;\n"
    "out vec3 v_normal;\n"
    "out float v_tendon;\n"
    "flat out float v_kind;\n"
    "flat out vec4 v_color;\n"
    "void main()\n"
    "{\n"
    "    vec3 place = a_place + u_shift;\n"
    "    v_normal = u_turn * a_normal;\n"
    "    v_tendon = a_tendon;\n"
    "    v_kind = a_kind;\n"
    "    v_color = vec4(linear(a_color.rgb), a_color.a);\n"
    "    gl_Position = u_clip * vec4(place, 1.0);\n"
    "    gl_ClipDistance[0] = -dot(u_plane, vec4(place, 1.0));\n"
    "}\n";

static const char muscle_fs[] =
    "in vec3 v_normal;\n"
    "in float v_tendon;\n"
    "flat in float v_kind;\n"
    "flat in vec4 v_color;\n"
    "uniform vec3 u_tendon;\n"
    "void main()\n"
    "{\n"
    "    float n2 = dot(v_normal, v_normal);\n"
    "    o_color = v_tendon > 0.0 ? vec4(u_tendon, 0.8) : v_color;\n"
    "    o_shape = vec4(n2 > 0.0 ? v_normal * inversesqrt(n2) : vec3(0.0, 0.0, 1.0), v_kind);\n"
    "}\n";

/* a_corner: which corner of which triangle. */
static const char cut_vs[] =
    "layout(location = 0) in vec3 a_place;\n"
    "layout(location = 1) in vec3 a_normal;\n"
    "layout(location = 2) in vec3 a_corner;\n"
    "out vec3 v_bary;\n"
    "out vec3 v_normal;\n"
    "flat out int v_face;\n"
    "void main()\n"
    "{\n"
    "    int k = int(a_corner.x);\n"
    "    v_bary = vec3(k == 0, k == 1, k == 2);\n"
    "    v_normal = a_normal;\n"
    "    v_face = int(a_corner.y);\n"
    "    gl_Position = u_clip * vec4(a_place + u_shift, 1.0);\n"
    "}\n";

static const char cut_fs[] =
    "in vec3 v_bary;\n"
    "in vec3 v_normal;\n"
    "flat in int v_face;\n"
    "uniform samplerBuffer u_face;\n"
    "uniform samplerBuffer u_cand;\n"
    "uniform samplerBuffer u_color;\n"
    "uniform vec3 u_fat;\n"
    "uniform int u_stride;\n"
    "uniform vec3 u_tendon;\n"
    "void main()\n"
    "{\n"
    "    vec4 list = texelFetch(u_face, v_face);\n"
    "    int first = int(list.x), last = first + u_stride * int(list.y), hit = first;\n"
    "    float best = 0.0, id = -1.0;\n"
    "    for (int c = first; c < last; c += u_stride) {\n"
    "        vec4 g = texelFetch(u_cand, c);\n"
    "        float here = dot(v_bary, g.xyz);\n"
    "        if (here > best) {\n"
    "            best = here;\n"
    "            id = g.w;\n"
    "            hit = c;\n"
    "        }\n"
    "    }\n"
    "    vec3 color = id < 0.0 ? u_fat : texelFetch(u_color, int(id)).rgb;\n"
    "    float kind = id < 0.0 ? 1024.0 : 512.0 + mod(id, 512.0);\n"
    "    bool is_tendon = id >= 0.0 && u_stride > 1 && dot(v_bary, texelFetch(u_cand, hit + 1).xyz) > 0.0;\n"
    "    o_color = is_tendon ? vec4(u_tendon, 0.0) : vec4(color, 0.0);\n"
    "    o_shape = vec4(normalize(u_turn * v_normal), -kind);\n"
    "}\n";

static const char solid_vs[] =
    "layout(location = 0) in vec3 a_place;\n"
    "layout(location = 1) in vec3 a_normal;\n"
    "uniform float u_is_section;\n"
    "out vec3 v_place;\n"
    "out vec3 v_normal;\n"
    "void main()\n"
    "{\n"
    "    vec3 place = a_place + u_shift;\n"
    "    v_place = u_turn * place;\n"
    "    v_normal = u_turn * a_normal;\n"
    "    gl_Position = u_clip * vec4(place, 1.0);\n"
    "    gl_ClipDistance[0] = u_is_section > 0.5 ? 1.0 : -dot(u_plane, vec4(place, 1.0));\n"
    "}\n";

static const char solid_fs[] =
    "in vec3 v_place;\n"
    "in vec3 v_normal;\n"
    "uniform vec4 u_color;\n"
    "uniform float u_kind;\n"
    "void main()\n"
    "{\n"
    "    vec3 n = normalize(v_normal);\n"
    "    o_color = u_color;\n"
    "    o_shape = vec4(gl_FrontFacing || u_kind < 0.0 ? n : -n, u_kind);\n"
    "}\n";

static const char to_linear[] =
    "vec3 linear(vec3 c)\n"
    "{\n"
    "    return mix(c / 12.92, pow((c + 0.055) / 1.055, vec3(2.4)), step(0.04045, c));\n"
    "}\n";

/* Three lights that move with the eye, a sky above a warm ground. All colours are linear. */
static const char light[] =
    "const vec3 key_dir = normalize(vec3(-0.50, 0.64, 0.58));\n"
    "const vec3 fill_dir = normalize(vec3(0.86, 0.08, 0.50));\n"
    "const vec3 rim_dir = normalize(vec3(0.35, 0.55, -0.75));\n"
    "vec3 ambient(vec3 n)\n"
    "{\n"
    "    return mix(vec3(0.20, 0.16, 0.15), vec3(0.40, 0.41, 0.43), 0.5 + 0.5 * n.y);\n"
    "}\n"
    "vec3 direct(vec3 n)\n"
    "{\n"
    "    return vec3(1.02, 0.96, 0.90) * max(0.0, (dot(n, key_dir) + 0.12) / 1.12) +\n"
    "           vec3(0.20, 0.21, 0.23) * max(0.0, dot(n, fill_dir)) + vec3(0.22, 0.22, 0.24) * max(0.0, dot(n, rim_dir));\n"
    "}\n"
    "float gleam(vec3 n, vec3 to_eye)\n" // cosines to the powers of 36 and 14
    "{\n"
    "    float wide = max(0.0, dot(n, normalize(key_dir + to_eye))), soft = max(0.0, dot(n, normalize(fill_dir + to_eye)));\n"
    "    float wide2 = wide * wide, wide4 = wide2 * wide2, wide8 = wide4 * wide4, wide16 = wide8 * wide8;\n"
    "    float soft2 = soft * soft, soft4 = soft2 * soft2;\n"
    "    return 0.42 * (wide16 * wide16 * wide4) + 0.05 * (soft4 * soft4 * soft4 * soft2);\n"
    "}\n";

/* Weighted sums over all layers, in any order: their mean colour, and exactly how much of the ground is seen. */
static const char skin_fs[] =
    "layout(location = 0) out vec4 o_sum;\n"
    "layout(location = 1) out vec4 o_weight;\n"
    "in vec3 v_place;\n"
    "in vec3 v_normal;\n"
    "uniform vec4 u_color;\n"
    "void main()\n"
    "{\n"
    "    vec3 n = normalize(v_normal), to_eye = normalize(-v_place);\n"
    "    if (!gl_FrontFacing) n = -n;\n"
    "    float graze = 1.0 - abs(dot(n, to_eye));\n"
    "    float a = mix(u_color.a, 1.0, 0.75 * graze * graze * graze * sqrt(u_color.a));\n"
    "    if (!gl_FrontFacing) a *= 0.3;\n"
    "    vec3 c = u_color.rgb * 0.85 * (ambient(n) + direct(n)) + 0.5 * gleam(n, to_eye);\n"
    "    o_sum = vec4(c * a, a);\n"
    "    o_weight = vec4(a, 0.0, 0.0, a);\n"
    "}\n";

/* The light on what is laid over the picture: more even than that on solid things. */
static const char line_light[] =
    "vec3 lit_line(vec3 c, vec3 n, vec3 place)\n"
    "{\n"
    "    return c * (0.35 + ambient(n) + 0.65 * direct(n)) + gleam(n, normalize(-place));\n"
    "}\n";

/* sn_color_pack undone. */
static const char unpack[] =
    "vec3 unpack_color(float c)\n"
    "{\n"
    "    return vec3(floor(c / 65536.0), mod(floor(c / 256.0), 256.0), mod(c, 256.0)) / 255.0;\n"
    "}\n";

/* Radius u_radius, but at least u_pixels wide on the picture, then grown by u_grow pixels. */
static const char line_vs[] =
    "layout(location = 0) in vec3 a_centre;\n"
    "layout(location = 1) in vec3 a_dir;\n"
    "uniform float u_radius;\n"
    "uniform float u_pixels;\n"
    "uniform float u_grow;\n"
    "uniform float u_slope;\n"
    "out vec3 v_normal;\n"
    "out vec3 v_place;\n"
    "void main()\n"
    "{\n"
    "    vec3 centre = a_centre + u_shift;\n"
    "    float w = max((u_clip * vec4(centre, 1.0)).w, 0.0);\n"
    "    vec3 place = centre + a_dir * (max(u_radius, u_pixels * u_slope * w) + u_grow * u_slope * w);\n"
    "    v_place = u_turn * place;\n"
    "    v_normal = u_turn * a_dir;\n"
    "    gl_Position = u_clip * vec4(place, 1.0);\n"
    "    gl_ClipDistance[0] = -dot(u_plane, vec4(centre, 1.0));\n"
    "}\n";

static const char line_fs[] =
    "layout(location = 0) out vec4 o_line;\n"
    "in vec3 v_place;\n"
    "in vec3 v_normal;\n"
    "uniform vec4 u_color;\n"
    "void main()\n"
    "{\n"
    "    vec3 n = normalize(v_normal);\n"
    "    vec3 c = linear(u_color.rgb);\n"
    "    if (u_color.a > 0.5) c = lit_line(c, n, v_place);\n"
    "    o_line = vec4(c, 1.0);\n"
    "}\n";

/* A line as a strip that faces the eye. a_what: side -1 or 1; tip -1..1, not 0 only beyond the ends; colour.
 * The strip lies as far in front of the line as the tube's surface does on average, at the same pixels. */
static const char fiber_vs[] =
    "layout(location = 0) in vec3 a_place;\n"
    "layout(location = 1) in vec3 a_along;\n"
    "layout(location = 2) in vec3 a_what;\n"
    "uniform float u_radius;\n"
    "uniform float u_pixels;\n"
    "uniform float u_slope;\n"
    "out vec2 v_at;\n"
    "out vec3 v_side;\n"
    "out vec3 v_tip;\n"
    "out vec3 v_place;\n"
    "flat out vec3 v_color;\n"
    "void main()\n"
    "{\n"
    "    vec3 at = a_place + u_shift;\n"
    "    float w = max((u_clip * vec4(at, 1.0)).w, 0.0), far = max(length(at), 1e-20);\n"
    "    float r = max(u_radius, u_pixels * u_slope * w);\n"
    "    vec3 front = -at / far, side = cross(a_along, front);\n"
    "    if (dot(side, side) < 1e-10) side = cross(abs(front.x) < 0.6 ? vec3(1.0, 0.0, 0.0) : vec3(0.0, 1.0, 0.0), front);\n"
    "    side = normalize(side);\n"
    "    vec3 tip = cross(front, side);\n"
    "    vec3 place = (at + r * (a_what.x * side + a_what.y * tip)) * (1.0 - min(0.75 * r / far, 0.5));\n"
    "    v_at = a_what.xy;\n"
    "    v_side = u_turn * side;\n"
    "    v_tip = u_turn * tip;\n"
    "    v_place = u_turn * place;\n"
    "    v_color = unpack_color(a_what.z);\n"
    "    gl_Position = u_clip * vec4(place, 1.0);\n"
    "    gl_ClipDistance[0] = -dot(u_plane, vec4(at, 1.0));\n"
    "}\n";

static const char fiber_in[] =
    "in vec2 v_at;\n"
    "in vec3 v_side;\n"
    "in vec3 v_tip;\n"
    "in vec3 v_place;\n"
    "flat in vec3 v_color;\n"
    "vec3 tube_normal()\n"
    "{\n"
    "    float rest = 1.0 - dot(v_at, v_at);\n"
    "    if (rest < 0.0) discard;\n"
    "    return normalize(v_at.x * v_side + v_at.y * v_tip - sqrt(rest) * normalize(v_place));\n"
    "}\n";

static const char fiber_fs[] =
    "void main()\n"
    "{\n"
    "    o_shape = vec4(tube_normal(), 1024.0);\n"
    "    o_color = vec4(linear(v_color), 0.25);\n"
    "}\n";

static const char fiber_line_fs[] =
    "layout(location = 0) out vec4 o_line;\n"
    "void main()\n"
    "{\n"
    "    o_line = vec4(lit_line(linear(v_color), tube_normal(), v_place), 1.0);\n"
    "}\n";

/* a_out: from the arrow's axis to its surface, in radii of its shaft; a_what: that radius, colour. */
static const char arrow_vs[] =
    "layout(location = 0) in vec3 a_centre;\n"
    "layout(location = 1) in vec3 a_normal;\n"
    "layout(location = 2) in vec3 a_out;\n"
    "layout(location = 3) in vec3 a_what;\n"
    "uniform float u_pixels;\n"
    "uniform float u_grow;\n"
    "uniform float u_slope;\n"
    "out vec3 v_normal;\n"
    "out vec3 v_place;\n"
    "flat out vec3 v_color;\n"
    "void main()\n"
    "{\n"
    "    vec3 centre = a_centre + u_shift;\n"
    "    float w = max((u_clip * vec4(centre, 1.0)).w, 0.0);\n"
    "    vec3 place = centre + a_out * max(a_what.x, u_pixels * u_slope * w) + a_normal * (u_grow * u_slope * w);\n"
    "    v_place = u_turn * place;\n"
    "    v_normal = u_turn * a_normal;\n"
    "    v_color = unpack_color(a_what.y);\n"
    "    gl_Position = u_clip * vec4(place, 1.0);\n"
    "    gl_ClipDistance[0] = -dot(u_plane, vec4(centre, 1.0));\n"
    "}\n";

static const char arrow_fs[] =
    "layout(location = 0) out vec4 o_line;\n"
    "in vec3 v_place;\n"
    "in vec3 v_normal;\n"
    "flat in vec3 v_color;\n"
    "uniform float u_is_lit;\n"
    "void main()\n"
    "{\n"
    "    vec3 c = linear(u_is_lit > 0.5 ? v_color : 0.16 * v_color);\n"
    "    if (u_is_lit > 0.5) c = lit_line(c, normalize(v_normal), v_place);\n"
    "    o_line = vec4(c, 1.0);\n"
    "}\n";

static const char screen_vs[] =
    "void main()\n"
    "{\n"
    "    gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0, 0.0, 1.0);\n"
    "}\n";

/* Places in view axes from depth. u_origin: the tile's corner from the picture's middle, samples; u_slope: per sample. */
static const char screen[] =
    "uniform sampler2D u_depth_map;\n"
    "uniform sampler2D u_shape;\n"
    "uniform vec2 u_depth;\n"
    "uniform vec2 u_origin;\n"
    "uniform float u_slope;\n"
    "uniform ivec2 u_size;\n"
    "float distance_of(float depth)\n"
    "{\n"
    "    return u_depth.y / (2.0 * depth - 1.0 - u_depth.x);\n"
    "}\n"
    "vec3 place_at(vec2 pixel, float far)\n"
    "{\n"
    "    return vec3((pixel + u_origin) * u_slope, -1.0) * far;\n"
    "}\n";

/* How much of the sky is seen, and the distance: McGuire et al., The Alchemy screen-space ambient obscurance algorithm,
 * HPG 2011. The 12 directions turn by sixteenths from sample to sample; the final pass takes the mean over 16. */
static const char occlusion_fs[] =
    "layout(location = 0) out vec2 o_open;\n"
    "uniform float u_radius;\n"
    "uniform float u_max_pixels;\n"
    "const vec2 spiral[12] = vec2[12](\n" // sqrt((i + 0.5) / 12) at the angle 2.4 i
    "    vec2(0.2041241, 0.0000000), vec2(-0.2607080, 0.2388123), vec2(0.0399376, -0.4546849),\n"
    "    vec2(0.3285473, 0.4286296), vec2(-0.6029957, -0.1067529), vec2(0.5712918, -0.3632616),\n"
    "    vec2(-0.1912204, 0.7107049), vec2(-0.3641984, -0.7016834), vec2(0.7904717, 0.2889426),\n"
    "    vec2(-0.8225548, 0.3392201), vec2(0.3967831, -0.8470910), vec2(0.2926046, 0.9341926));\n"
    "void main()\n"
    "{\n"
    "    ivec2 here = ivec2(gl_FragCoord.xy);\n"
    "    float far = distance_of(texelFetch(u_depth_map, here, 0).r);\n"
    "    vec4 shape = texelFetch(u_shape, here, 0);\n"
    "    o_open = vec2(1.0, far);\n"
    "    if (shape.w <= 0.0) return;\n"
    "    vec3 place = place_at(gl_FragCoord.xy, far), n = shape.xyz;\n"
    "    float reach = clamp(u_radius / (u_slope * far), 2.0, u_max_pixels);\n"
    "    float turn = 0.3927 * float((here.x * 5 + here.y * 9) & 15);\n"
    "    vec2 along = reach * vec2(cos(turn), sin(turn));\n"
    "    mat2 spin = mat2(along.x, along.y, -along.y, along.x);\n"
    "    float sum = 0.0, r2 = u_radius * u_radius;\n"
    "    for (int i = 0; i < 12; i++) {\n"
    "        ivec2 there = here + ivec2(round(spin * spiral[i]));\n"
    "        if (any(lessThan(there, ivec2(0))) || any(greaterThanEqual(there, u_size))) continue;\n"
    "        vec3 v = place_at(vec2(there) + 0.5, distance_of(texelFetch(u_depth_map, there, 0).r)) - place;\n"
    "        float d2 = dot(v, v), near = max(0.0, 1.0 - d2 / r2);\n"
    "        sum += near * near * max(0.0, dot(v, n) * inversesqrt(d2 + 1e-4 * r2) - 0.08);\n"
    "    }\n"
    "    o_open.x = clamp(1.0 - 2.6 * sum / 12.0, 0.0, 1.0);\n"
    "}\n";

/* The parts of the picture in which nothing is solid are drawn without SOLID. */
static const char with_solid[] =
    "#define SOLID\n";

static const char final_fs[] =
    "layout(location = 0) out vec4 o_picture;\n"
    "uniform sampler2D u_color;\n"
    "uniform sampler2D u_open;\n"
    "uniform sampler2D u_skin_sum;\n"
    "uniform sampler2D u_skin_weight;\n"
    "uniform sampler2D u_line;\n"
    "uniform sampler2D u_line_depth;\n"
    "uniform vec3 u_show;\n"
    "uniform float u_unit;\n"
    "uniform int u_samples;\n"
    "float open_sky(ivec2 here, float far)\n"
    "{\n"
    "    float sum = 0.0, n = 0.0;\n"
    "    for (int y = -2; y < 2; y++)\n"
    "        for (int x = -2; x < 2; x++) {\n"
    "            vec2 open = texelFetch(u_open, clamp(here + ivec2(x, y), ivec2(0), u_size - 1), 0).rg;\n"
    "            float w = abs(open.y - far) < 0.01 * u_unit ? 1.0 : 0.0;\n"
    "            sum += w * open.x;\n"
    "            n += w;\n"
    "        }\n"
    "    return n > 0.0 ? sum / n : 1.0;\n"
    "}\n"
    "// A line where two things meet, and on the far side of a step in depth.\n"
    "float outline(ivec2 here, vec4 shape, vec3 place)\n"
    "{\n"
    "    float line = 0.0;\n"
    "    for (int k = 0; k < 4; k++) {\n"
    "        ivec2 step = (k & 1) == 0 ? ivec2(1, 0) : ivec2(0, 1);\n"
    "        ivec2 p = here + ((k & 2) == 0 ? 1 : -1) * ((u_samples + 1) / 2) * step;\n"
    "        if (any(lessThan(p, ivec2(0))) || any(greaterThanEqual(p, u_size))) continue;\n"
    "        float kind = texelFetch(u_shape, p, 0).w;\n"
    "        vec3 v = place_at(vec2(p) + 0.5, texelFetch(u_open, p, 0).g) - place;\n"
    "        bool is_flat = shape.w < 0.0 && kind < 0.0;\n"
    "        if (kind != shape.w && shape.w < 1024.0 && (is_flat || v.z < 0.002 * u_unit)) line = max(line, is_flat ? 0.72 : 0.5);\n"
    "        float rise = dot(v, shape.xyz) / u_unit;\n"
    "        if (kind == shape.w && shape.w > 0.0) line = max(line, 0.5 * smoothstep(0.004, 0.016, rise));\n"
    "        if (kind == 1024.0 && shape.w == 1024.0) line = max(line, 0.6 * smoothstep(0.0012, 0.008, v.z / u_unit));\n"
    "    }\n"
    "    return line;\n"
    "}\n"
    "void main()\n"
    "{\n"
    "    ivec2 here = ivec2(gl_FragCoord.xy);\n"
    "    vec4 c = vec4(0.0);\n"
    "#ifdef SOLID\n"
    "    vec4 shape = texelFetch(u_shape, here, 0);\n"
    "    float far = texelFetch(u_open, here, 0).g;\n"
    "    if (shape.w != 0.0) {\n"
    "        vec4 paint = texelFetch(u_color, here, 0);\n"
    "        vec3 place = place_at(gl_FragCoord.xy, far), n = shape.xyz, to_eye = normalize(-place);\n"
    "        vec3 albedo = paint.rgb;\n"
    "        if (shape.w > 0.0) {\n"
    "            float open = open_sky(here, far);\n"
    "            vec3 bounce = mix(albedo, vec3(1.0), open); // what hides the sky sends back its own colour\n"
    "            c.rgb = albedo * bounce * open * (ambient(n) + mix(0.55, 1.0, open) * direct(n));\n"
    "            c.rgb += paint.a * open * gleam(n, to_eye);\n"
    "        } else {\n"
    "            c.rgb = albedo;\n"
    "        }\n"
    "        c.rgb *= 1.0 - outline(here, shape, place);\n"
    "        c.a = 1.0;\n"
    "    }\n"
    "#endif\n"
    "    if (u_show.x > 0.5) {\n"
    "        vec4 sum = texelFetch(u_skin_sum, here, 0);\n"
    "        float weight = texelFetch(u_skin_weight, here, 0).r;\n"
    "        if (weight > 0.0) c = c * sum.a + vec4(sum.rgb / weight, 1.0) * (1.0 - sum.a);\n"
    "    }\n"
    "    if (u_show.y > 0.5) {\n"
    "        vec4 line = texelFetch(u_line, here, 0);\n"
    "        float d = texelFetch(u_line_depth, here, 0).r;\n"
    "        bool is_hidden = false;\n"
    "#ifdef SOLID\n"
    "        is_hidden = distance_of(d) > far + 1e-4 * u_unit;\n"
    "#endif\n"
    "        c = mix(c, vec4(line.rgb, 1.0), line.a * (is_hidden ? 0.42 : 1.0));\n"
    "    }\n"
    "    o_picture = c;\n"
    "}\n";

const char *const sn_shader_muscle_vs[] = {version, frame, to_linear, muscle_vs, NULL};
const char *const sn_shader_muscle_fs[] = {version, solid_out, muscle_fs, NULL};
const char *const sn_shader_cut_vs[] = {version, frame, cut_vs, NULL};
const char *const sn_shader_cut_fs[] = {version, solid_out, cut_fs, NULL};
const char *const sn_shader_solid_vs[] = {version, frame, solid_vs, NULL};
const char *const sn_shader_solid_fs[] = {version, solid_out, solid_fs, NULL};
const char *const sn_shader_skin_fs[] = {version, light, skin_fs, NULL};
const char *const sn_shader_line_vs[] = {version, frame, line_vs, NULL};
const char *const sn_shader_line_fs[] = {version, light, to_linear, line_light, line_fs, NULL};
const char *const sn_shader_fiber_vs[] = {version, frame, unpack, fiber_vs, NULL};
const char *const sn_shader_fiber_fs[] = {version, solid_out, to_linear, fiber_in, fiber_fs, NULL};
const char *const sn_shader_fiber_line_fs[] = {version, light, to_linear, line_light, fiber_in, fiber_line_fs, NULL};
const char *const sn_shader_arrow_vs[] = {version, frame, unpack, arrow_vs, NULL};
const char *const sn_shader_arrow_fs[] = {version, light, to_linear, line_light, arrow_fs, NULL};
const char *const sn_shader_screen_vs[] = {version, screen_vs, NULL};
const char *const sn_shader_occlusion_fs[] = {version, screen, occlusion_fs, NULL};
const char *const sn_shader_final_fs[] = {version, with_solid, screen, light, final_fs, NULL};
const char *const sn_shader_final_rest_fs[] = {version, screen, light, final_fs, NULL};
/* clang-format on */
