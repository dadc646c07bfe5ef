/* lsn_help.c - sinew.help_text: name -> signature and what it does, for the REPL's help(). A method of a
 * scene is "scene:solve", a function "sinew.surface.load". */
#include "lsn.h"

typedef struct help {
    const char *name, *text;
} help;

static const help general[] = {
    {"sinew",
     "sinew  surfaces, shapes, scenes, pictures and tets: help(\"sinew.scene\"), help(\"scene:solve\"), ..."},
    {"sinew.version", "sinew.version  the version, a string"},
    {"sinew.time", "sinew.time() -> seconds  a clock that never goes back, for measuring"},
    {"sinew.threads",
     "sinew.threads([n]) -> n  threads that long steps use; 0: one per core. No result depends on it"},
    {"sinew.folder", "sinew.folder(path) -> path | nil, message  makes the folder when it is missing; its "
                     "parent must be there"},
    {"sinew.vec3", "sinew.vec3(x, y, z) -> vec3  a point or vector: p.x p.y p.z, p[1] p[2] p[3], + - * / ==; "
                   "{x, y, z} does "
                   "wherever a point is wanted"},
    {"vec3:dot", "v:dot(w) -> number  scalar product"},
    {"vec3:cross", "v:cross(w) -> vec3  vector product"},
    {"vec3:length", "v:length() -> number"},
    {"vec3:distance", "p:distance(q) -> number  distance of two points"},
    {"vec3:unit", "v:unit() -> vec3  v with length 1; zero stays zero"},
};

static const help surfaces[] = {
    {"sinew.surface.load",
     "sinew.surface.load(path) -> surface | nil, message  reads .obj .ply .stl .off .vtp"},
    {"sinew.surface.new", "sinew.surface.new(vertices, faces) -> surface  from a list of points and a list "
                          "of {a, b, c}, indices from 1"},
    {"surface:save", "s:save(path [, {ascii=false}]) -> true | nil, message  writes .obj .ply .stl .off"},
    {"surface:copy", "s:copy() -> surface  one that changes on its own"},
    {"surface:close", "s:close()  gives its memory back at once; the surface cannot be used afterwards"},
    {"surface:vertex_count", "s:vertex_count() -> number of vertices"},
    {"surface:face_count", "s:face_count() -> number of triangles"},
    {"surface:vertex", "s:vertex(i) -> point"},
    {"surface:face", "s:face(i) -> {a, b, c}  vertex indices, counter-clockwise seen from outside"},
    {"surface:bounds", "s:bounds() -> {min=, max=}"},
    {"surface:area", "s:area() -> number"},
    {"surface:volume", "s:volume() -> number  signed; meaningful for closed surfaces"},
    {"surface:check", "s:check() -> {closed=, manifold=, oriented=, components=, boundary_edges=, "
                      "nonmanifold_edges=, nonmanifold_vertices=, "
                      "degenerate_faces=, duplicate_vertices=, duplicate_faces=, unused_vertices=, "
                      "self_intersections=, first_pair=}  what "
                      "is right and wrong with it"},
    {"surface:repair",
     "s:repair{weld=, fill_holes=, self_intersections=true, components=\"all\", wrap=\"auto\", tolerance=, "
     "alpha=, offset=, time_limit=} -> surface, report  a closed, manifold, outward surface without "
     "self-intersections; s stays as it is. Joins vertices nearer than weld, drops degenerate and duplicate "
     "faces, orients, fills holes up to fill_holes across, removes components inside others (\"largest\" "
     "keeps "
     "one only), cuts crossings out and unites components that cross. Where that does not do (wrap: "
     "\"auto\", "
     "\"always\", \"never\") a new surface is wrapped around all, not farther away than tolerance; it enters "
     "gaps wider than 2 alpha. Defaults by the diagonal of the bounds: weld 1e-6, fill_holes 0.25, tolerance "
     "0.003 (more where the wrap would have over 100,000 faces). report: {steps={{name=, moved=, counts "
     "...}, "
     "...}, wrapped=, moved=, missed=, check=}: moved is "
     "the largest distance of the result from s, missed that of what is seen of s from outside from the "
     "result"},
    {"surface:transform",
     "s:transform{scale=1, rotate={axis=, degrees=}, translate=} -> s  changes s itself: scales, then "
     "turns about the origin, then moves"},
    {"surface:mirror", "s:mirror{point={0, 0, 0}, normal=} -> s  reflects s itself in a plane; outside stays "
                       "outside. s:copy():mirror{...} "
                       "for a second one"},
    {"surface:cut",
     "s:cut{point={0, 0, 0}, normal=} -> surface  the half on the side that normal points to, with a cap in "
     "the plane; s stays as it is. s: closed; shells in it that are turned inwards are holes of the cap"},
    {"surface:raycast",
     "s:raycast(origin, direction) -> list of {distance=, point=, face=, entering=}  in order along the ray"},
    {"surface:closest", "s:closest(p) -> {point=, distance=, face=}  the point of the surface nearest to p"},
    {"surface:contains", "s:contains(p) -> boolean  is p inside (winding number above 1/2)"},
};

static const help shapes[] = {
    {"sinew.shape.sphere", "sinew.shape.sphere(center, radius) -> shape"},
    {"sinew.shape.ellipsoid", "sinew.shape.ellipsoid(center, {rx, ry, rz}) -> shape"},
    {"sinew.shape.capsule",
     "sinew.shape.capsule(a, b, ra [, rb]) -> shape  a cone with round ends, radius ra at a, rb at b"},
    {"sinew.shape.box",
     "sinew.shape.box(center, {hx, hy, hz} [, rounding]) -> shape  half sizes, radius of the edges"},
    {"sinew.shape.union", "sinew.shape.union(a, b, ...) -> shape  all of them; a list will do"},
    {"sinew.shape.smooth_union",
     "sinew.shape.smooth_union(k, a, b, ...) -> shape  all of them, blended over a length k"},
    {"sinew.shape.subtract", "sinew.shape.subtract(a, b) -> shape  a without b"},
    {"sinew.shape.smooth_subtract",
     "sinew.shape.smooth_subtract(k, a, b) -> shape  a without b, the rim rounded over a length k"},
    {"sinew.shape.intersect",
     "sinew.shape.intersect(a, b, ...) -> shape  what lies in all of them; a list will do"},
    {"sinew.shape.torus", "sinew.shape.torus(center, axis, ring, tube) -> shape  a ring of that radius "
                          "around the axis, tube its half "
                          "thickness"},
    {"sinew.shape.plate",
     "sinew.shape.plate(a, b, c, radius) -> shape  all within radius of the triangle a, b, c"},
    {"shape:transform", "shape:transform{scale=1, rotate={axis=, degrees=}, translate=} -> shape  another "
                        "one: scaled (a number or "
                        "{x, y, z}), then turned about the origin, then moved"},
    {"shape:mirror", "shape:mirror{point={0, 0, 0}, normal=} -> shape  another one, reflected in a plane"},
    {"shape:mesh", "shape:mesh{cell=} -> surface  closed, with triangles of edge length cell"},
    {"shape:value", "shape:value(p) -> number  signed distance or a bound of it, negative inside"},
    {"shape:bounds", "shape:bounds() -> {min=, max=}  a box that holds it"},
    {"shape:close", "shape:close()  gives its memory back at once"},
};

static const help scenes[] = {
    {"sinew.scene", "sinew.scene{name=\"scene\", unit=\"m\", up=\"y\"} -> scene  up: \"y\" or \"z\""},
    {"scene:name", "scene:name() -> string"},
    {"scene:unit", "scene:unit() -> string"},
    {"scene:up", "scene:up() -> \"y\" or \"z\""},
    {"scene:bounds", "scene:bounds() -> {min=, max=} or nil  of skin, bones and control points"},
    {"scene:revision", "scene:revision() -> number  counts edits"},
    {"scene:close", "scene:close()  gives its memory back at once; the scene cannot be used afterwards"},
    {"scene:set_skin", "scene:set_skin(surface)  a closed surface, copied"},
    {"scene:skin", "scene:skin() -> surface or nil  a copy"},
    {"scene:add_bone", "scene:add_bone(name, surface) -> bone  a closed surface, copied; bones may cross"},
    {"scene:bone", "scene:bone(name) -> bone"},
    {"scene:bones", "scene:bones() -> list of bones in the order added"},
    {"scene:remove_bone", "scene:remove_bone(name)  and its joints"},
    {"scene:place_bone",
     "scene:place_bone{name=, template=, ...} -> bone, report  puts a bone of the library into the scene; a "
     "name "
     "that ends in _r (.r, _right ...) gives the mirror image of the template, which is of the left side. A "
     "pick is "
     "a point, a ray {origin=, direction=} or a pixel {camera=, size=, pixel={x, y}}: rays give the middle "
     "between "
     "their first two hits with the skin. All kinds take margin= (the bone is moved inwards where it comes "
     "nearer to "
     "the skin; report.clearance tells). "
     "Cylinder bones: from=pick, to=pick, thickness=1 (over the one in proportion to the length) or \"kept\" "
     "(the "
     "template's own), twist=degrees, front={0, 0, 1}; report {from=, to=, length=}. "
     "Curve bones: along={points} or {camera=, size=, stroke={{x, y}, ...}} (needs plane), towards the head, "
     "count= or spacing=, plane={point=, normal=} (projects onto it), range={0, 1} (part of the curve by "
     "length), "
     "size={a, b} (of the first to the last), fill=1, thickness=1, front=, reversed=false, control_points=; "
     "one bone, "
     "whose piece k has its landmarks as NAME_k; report {count=, length=, spacing=, moved=, rms=, fill=}. "
     "Shape bones: at=pick, size=1, rotate={axis=, degrees=}, fit=false (fits the template to the skin "
     "around it), "
     "and for the fit iterations=, tolerance=, max_residual=, stiffness=, trim=, keep_scale=; report "
     "{rigid=, cage=, "
     "inverted_faces=, crossings=, crossings_before=}, each step with residual={...}, iterations=, stop="},
    {"scene:mirror_bones", "scene:mirror_bones{plane={point=, normal=}} -> {added=, replaced=}  every bone "
                           "and joint of a side gets its image "
                           "under the name of the other side (_l and _r, _L _R, .l .r, .L .R, _left _right); "
                           "the left one counts where both "
                           "are there. plane: that of scene:cut, else x = 0"},
    {"scene:cut",
     "scene:cut{point={0, 0, 0}, normal=}  a half model: keeps the side that the normal points to; caps "
     "carry no skin condition. Whole surfaces are kept: scene:cut(nil) brings them back"},
    {"scene:add_joint",
     "scene:add_joint{name=, parent=, child=, center=, axes={x, y, z}}  parent and child: bones or "
     "their names; axes are made orthonormal, those of space when not given"},
    {"scene:remove_joint", "scene:remove_joint(name)"},
    {"scene:joints", "scene:joints() -> list of {name=, parent=, child=, center=, axes=}"},
    {"scene:tetrahedralize",
     "scene:tetrahedralize{edge_length=, bone_edge_length=, adaptive=false, max_volume=, radius_edge=1.414, "
     "time_limit=300} -> {vertices=, tets=, seconds=, ...}  fills the soft tissue between skin and bones with "
     "tets; edge_length is 1/80 of the skin's diagonal when not given. adaptive: these lengths where muscles "
     "meet each other or the fat and along their curves, up to three times longer ones elsewhere: a third of the "
     "tets or fewer, for a first mesh and a solve more. The muscles must be there. The mesh stays when they are "
     "edited: one that moves far out of where it is fine is less exact until tetrahedralize is called again"},
    {"scene:set_fat", "scene:set_fat(value)  tissue value of fat on the skin, 0.2 at first"},
    {"scene:fat", "scene:fat() -> value"},
    {"scene:set_alpha", "scene:set_alpha(value)  weight of the curves against smoothness, 5 at first"},
    {"scene:alpha", "scene:alpha() -> value"},
    {"scene:add_muscle",
     "scene:add_muscle(name, {points={p1, p2, ...}, tissue=1}) -> muscle, scene:add_muscle(name, "
     "{heads={{points=, "
     "tissue=}, ...}}) -> muscle  a curve through 2 or more points, origin first; tissue: a number, or one "
     "for each "
     "point. heads: 1 to 64 curves that make one muscle; fibers need one end that all share"},
    {"scene:draw_muscle",
     "scene:draw_muscle(name, {stroke={{x, y}, ...}, camera=\"front\", size={800, 600}, depth=\"clear\", "
     "points=4, "
     "tissue=1, snap=0, margin=}) -> muscle, {rms=, max=, inside_bone=, outside_skin=, path_length=, "
     "snapped=, "
     "origin=, insertion=}  a stroke in pixels of that picture, which begins and ends over a bone, (0, 0) "
     "the "
     "top left pixel; depth \"clear\" keeps inside the skin and outside of bones by the margin (1 % of the "
     "skin's diagonal), \"linear\" runs straight from depth to depth; snap: pixels that an end may miss by"},
    {"scene:muscle", "scene:muscle(name) -> muscle"},
    {"scene:muscles", "scene:muscles() -> list of muscles in the order added"},
    {"scene:remove_muscle", "scene:remove_muscle(name)"},
    {"scene:solve", "scene:solve{quick=false, solver=\"auto\"} -> {seconds=, unknowns=, collocation_points=, "
                    "residual=, tissues=, "
                    "factorized=, ...}  solves the tissue functions; does nothing when they are up to date. "
                    "tissues: the names of "
                    "those solved for. An edit is solved for by the factor of before (changed_rows: rows of "
                    "the curves that it does "
                    "not have); factorized: a new one was made, factorized_muscles: anisotropic ones that "
                    "got one of their own. "
                    "quick: for the picture while something is edited: fields that change by less than 1e-3 "
                    "of the largest tissue "
                    "value may stay (kept: how many); pictures then show these, and what else asks for "
                    "fields solves exactly first. "
                    "solver: \"direct\" (a factor: memory of some n^4/3), \"iterative\" (conjugate gradients "
                    "with multigrid, memory in "
                    "proportion to the mesh, the same fields to 1e-8) or \"auto\", direct up to 1.5 million "
                    "unknowns; stays for later "
                    "solves; solver and iterations in the result tell what was done. "
                    "residual: |A x - b| over |b| of a sum of the fields. seconds_assembly and "
                    "seconds_analysis are those of the tet "
                    "mesh; seconds_factor, seconds_solve of this solve; seconds_frames and "
                    "seconds_anisotropic are summed over the "
                    "anisotropic muscles, which run side by side"},
    {"scene:values_at",
     "scene:values_at(p) -> {fat=, NAME=, ...} or nil  the tissue functions at p; nil outside the tet mesh"},
    {"scene:tissue_at", "scene:tissue_at(p) -> muscle name | \"fat\" | \"bone:NAME\" | nil outside"},
    {"scene:report", "scene:report() -> {muscles={NAME={volume=, tets=, components=, length=, "
                     "length_outside=, origin=, insertion=, "
                     "heads=, fiber_length=, pennation_angle=, pcsa=, belly_volume=, tendon_volume=, "
                     "fiber_check=}}, fat_volume=, "
                     "tissues_per_tet={...}, body={...}, solve={...}, timings={...}}  extracts first. "
                     "origin, insertion: {bone=, "
                     "area=, centroid=, distance=} of the bone's surface that the muscle covers within a "
                     "quarter of its curve from "
                     "that end (area 0: it touches none, the nearest bone then); of several heads those of "
                     "the first, all in heads. "
                     "The fields from fiber_length on as in part:architecture. tissues_per_tet[k]: tets with "
                     "k tissues, the last: "
                     "that many or more"},
    {"scene:render",
     "scene:render{file=, size={800, 600}, camera=\"front\", show={\"muscles\", \"bones\", \"skin\"}, "
     "clip={point=, normal=}, "
     "background=\"white\", skin_opacity=0.3, samples=2, fiber_count=150, renderer=} -> image  camera: front "
     "back left "
     "right top bottom "
     "iso, {eye=, "
     "target=, up=, fov=30} or {azimuth=, elevation=, zoom=}; show also curves, points, fibers (fiber_count "
     "lines in each "
     "muscle; solid where muscles are not shown), frames (e1 red, e2 green, e3 blue, as long as the roots of "
     "the "
     "eigenvalues, of muscles that have one); tendon is drawn pale; a picture after another of the same "
     "scene is fast, with samples=1 (coarser edges) "
     "faster still; renderer is osmesa, egl or auto, the program's --renderer when not given; clip "
     "removes the side its normal "
     "points to; background: {r, g, b, a} in 0..1, \"#rrggbb\", \"white\", \"black\" or \"transparent\""},
    {"scene:extract", "scene:extract{margin=0.001} -> extraction  every muscle and \"fat\" as tets that fit "
                      "each other exactly"},
    {"bone:name", "bone:name() -> string"},
    {"bone:surface", "bone:surface() -> surface  a copy; of what is left in a half model"},
    {"bone:move", "bone:move(v) -> bone"},
    {"bone:rotate",
     "bone:rotate{axis=, degrees=, about=} -> bone  about: a point, the middle of its box when not given"},
    {"bone:scale", "bone:scale(k [, {about=}]) -> bone"},
    {"bone:ends", "bone:ends() -> from, to  or nil: only bones placed between two points have ends"},
    {"bone:set_ends",
     "bone:set_ends(from, to [, {thickness=1}]) -> bone  stretched along its axis and turned by the "
     "smallest angle; thickness: factor across the axis"},
    {"bone:landmark", "bone:landmark(name) -> point, radius  radius 0: the centre of a joint"},
    {"bone:landmarks", "bone:landmarks() -> list of {name=, point=, radius=}"},
    {"bone:set_landmark", "bone:set_landmark(name, point [, radius]) -> bone"},
    {"bone:clearance",
     "bone:clearance{margin=0} -> {least=, at=, outside=, near=}  signed distance of its vertices from "
     "the skin: the least one, where, how many are outside, how many nearer than the margin"},
    {"bone:keep_clear",
     "bone:keep_clear{margin=} -> {before=, after=, moved=, moved_vertices=, rounds=}  moves what comes "
     "nearer to the skin inwards, and what is around it along with it"},
    {"sinew.bones.list",
     "sinew.bones.list() -> list of {name=, kind=, faces=, fits=, landmarks={names}}  kind: "
     "\"cylinder\", \"curve\" or \"shape\"; fits: it can be fitted to a skin"},
    {"sinew.bones.surface",
     "sinew.bones.surface(name [, \"cage\" | \"skin\"]) -> surface  of a template: metres, left "
     "side, +x lateral, +y up, +z front"},
    {"sinew.bones.add", "sinew.bones.add{name=, kind=, mesh=surface, ...}  a template of your own, for this "
                        "run of the program. Cylinders: "
                        "from=, to= (its handles). Curve bones: length= (spacing) with the mesh around the "
                        "origin, +y along the curve; or "
                        "from=, to=, front= for a mesh of any place. Shapes: cage= and skin= (surfaces) when "
                        "they are to be fitted. All: "
                        "landmarks={NAME={x, y, z} or {point=, radius=}}"},
};

static const help muscles[] = {
    {"muscle:name", "m:name() -> string"},
    {"muscle:head_count", "m:head_count() -> number of curves"},
    {"muscle:head",
     "m:head(k) -> head  with the point, tissue and curve functions of a muscle; those of a muscle "
     "with one head are that head's, with several they raise (but set_tissue(value), for all)"},
    {"muscle:point_count", "m:point_count() -> number of control points"},
    {"muscle:point", "m:point(i) -> point  1 is the origin, the last the insertion"},
    {"muscle:set_point", "m:set_point(i, p)  moves a control point"},
    {"muscle:insert_point", "m:insert_point(i, p [, tissue])  before point i; point_count + 1 appends"},
    {"muscle:remove_point", "m:remove_point(i)  two must stay"},
    {"muscle:tissue", "m:tissue(i) -> value  at control point i"},
    {"muscle:set_tissue",
     "m:set_tissue(i, value), m:set_tissue(value)  at one control point or all: more makes it thicker"},
    {"muscle:curve", "m:curve(n) -> list of n points  evenly spaced along the curve"},
    {"muscle:length", "m:length() -> number  of the curve; of all heads together"},
    {"muscle:set_frame", "m:set_frame{angle=0, eigenvalues={1, 1, 1}, axis=}, m:set_frame(nil)  anisotropy: "
                         "tissue spreads by the "
                         "eigenvalues (each > 0) along the frame's e1 (the curve's tangent), e2 and e3; a "
                         "larger one makes the muscle "
                         "wider that way. axis: e2 points towards it at the first point, as nearly as it "
                         "can; without one, towards the "
                         "coordinate axis that the curve runs along least. angle: turns e2 and e3 about e1, "
                         "in degrees. The frame is "
                         "carried along the curve without twist. Costs a factorization of its own unless all "
                         "are 1; nil turns it off"},
    {"muscle:frame", "m:frame() -> {angle=, eigenvalues=, axis=, e1=, e2=, e3=} or nil  at the first point"},
    {"muscle:volume", "m:volume() -> number  exact, of the region that it wins; solves first"},
    {"muscle:set_volume", "m:set_volume(v)  scales its tissue values so that it has this volume, to 0.001 %; "
                          "needs no solve. Raises when "
                          "there is no room for it, and says how much there is"},
    {"muscle:set_preserve_volume", "m:set_preserve_volume(true|false)  from now on every solve scales its "
                                   "tissue values so that the volume stays "
                                   "what it is now, whatever is edited; set_volume then sets what is kept"},
    {"muscle:preserved_volume", "m:preserved_volume() -> number or nil"},
    {"muscle:set_pennation", "m:set_pennation{kind=, angle=, sheets=2}, m:set_pennation(nil)  how fibers "
                             "run. fusiform: along the muscle's "
                             "shape, the default; parallel: along the line of action; convergent: drawn "
                             "together at the insertion; unipennate, "
                             "bipennate, multipennate: at `angle` degrees (0..80; a list is spread evenly "
                             "from origin to insertion) to the line "
                             "of action, along e3 of the frame, to one side, towards the sheet of the curve "
                             "and e2 from both, or towards "
                             "`sheets` of them (2..16)"},
    {"muscle:pennation", "m:pennation() -> {kind=, angle=, sheets=}"},
    {"muscle:set_tendon", "m:set_tendon{length=, area=}, m:set_tendon(nil)  tendon is what lies within this "
                          "length of curve of an end, and "
                          "outwards of where the cross-section first reaches this area"},
    {"muscle:tendon", "m:tendon() -> {length=, area=} or nil"},
    {"head:point_count", "h:point_count() -> number of control points"},
    {"head:point", "h:point(i) -> point  1 is the origin, the last the insertion"},
    {"head:set_point", "h:set_point(i, p)  moves a control point"},
    {"head:insert_point", "h:insert_point(i, p [, tissue])  before point i; point_count + 1 appends"},
    {"head:remove_point", "h:remove_point(i)  two must stay"},
    {"head:tissue", "h:tissue(i) -> value  at control point i"},
    {"head:set_tissue", "h:set_tissue(i, value), h:set_tissue(value)  at one control point or all"},
    {"head:curve", "h:curve(n) -> list of n points  evenly spaced along the curve"},
    {"head:length", "h:length() -> number  of the curve"},
    {"head:frame",
     "h:frame(t) -> {e1=, e2=, e3=, point=}  the muscle's frame at t from 0 (origin) to 1 (insertion)"},
};

static const help results[] = {
    {"sinew.image.new",
     "sinew.image.new{size={w, h}, background=\"white\"} -> image  an empty one to draw on"},
    {"image:paste", "img:paste(other, x, y) -> img  lays other over img, its top left pixel at (x, y); what "
                    "does not fit is cut off"},
    {"image:fill",
     "img:fill{x=1, y=1, width=, height=, color=} -> img  a rectangle; as large as img when not given"},
    {"image:line",
     "img:line{points={{x, y}, ...}, width=1, color=\"black\"} -> img  whole numbers are the middles "
     "of pixels; one point gives a dot"},
    {"image:text",
     "img:text{x=, y=, text=, size=16, color=\"black\", align=\"left\", rotate=0} -> img  one line of "
     "text on the baseline y; align: left, center, right; rotate: degrees, counter-clockwise"},
    {"image:text_size", "img:text_size{text=, size=16} -> width, height, ascent  of one line of text, "
                        "pixels; ascent: the part of height above the baseline"},
    {"image:flip", "img:flip() -> image  a copy with left and right changed"},
    {"image:resize",
     "img:resize(w, h) -> image  a copy of another size, each pixel the mean of what it covers"},
    {"sinew.image.load", "sinew.image.load(path) -> image | nil, message  reads .png"},
    {"sinew.image.compare",
     "sinew.image.compare(a, b [, {max=0, count=0}]) -> {equal=, max=, count=, rmse=, diff=image}  equal: "
     "no more than count pixels differ by more than max (0..255) in a channel"},
    {"image:save",
     "img:save(path) -> true | nil, message  writes .png; a rendered one carries its camera as text"},
    {"image:width", "img:width() -> pixels"},
    {"image:height", "img:height() -> pixels"},
    {"image:pixel", "img:pixel(x, y) -> r, g, b, a  0..255; (1, 1) is the top left pixel"},
    {"image:close", "img:close()  gives its memory back at once"},
    {"extraction:names", "x:names() -> list of names  in the order of the material ids, \"fat\" first"},
    {"extraction:part", "x:part(name) -> part"},
    {"extraction:tet_count", "x:tet_count() -> number"},
    {"extraction:vertex_count", "x:vertex_count() -> number"},
    {"extraction:check",
     "x:check() -> {conforming=, manifold=, positive=, volume_error=, nonmanifold_edges=, "
     "nonmanifold_vertices=, bad_faces=, "
     "inverted=, min_volume=, max_volume=, moved=, largest_move=}  what holds of it"},
    {"extraction:save",
     "x:save(path) -> true | nil, message  .vtu .msh: all tissues with ids and names, the field envelope, "
     "and per tet "
     "fiber (unit vectors) and tendon (1 or 0) when it comes from a scene; .mesh: ids and names, tendon with "
     "ids of its "
     "own after the last tissue; a path without extension: a folder with one .obj for each muscle"},
    {"extraction:mirror",
     "x:mirror{point=, normal=} -> extraction  both sides of a half model, joined without a seam; the plane "
     "is "
     "that of scene:cut where none is given. A part "
     "without a side is one part on both; the image of NAME_l goes to NAME_r and the other way round (also "
     "_L _R, .l .r, .L .R, _left _right), new parts come last. Fibers are reflected, too"},
    {"extraction:fiber_lines", "x:fiber_lines{count=100, file=} -> {NAME={line, ...}, ...}  as "
                               "part:fiber_lines, for every muscle that has fibers"},
    {"extraction:close", "x:close()  gives its memory back at once"},
    {"part:name", "part:name() -> string"},
    {"part:volume", "part:volume() -> number"},
    {"part:tet_count", "part:tet_count() -> number"},
    {"part:surface", "part:surface() -> surface  its boundary"},
    {"part:save", "part:save(path) -> true | nil, message  .obj .ply .stl .off: the surface; .vtu .mesh "
                  ".msh: the tets, with "
                  "fibers as x:save"},
    {"part:fibers", "part:fibers{points=, heads=, kind=, angle=, sheets=, axis=, frame_angle=} -> list of "
                    "{point=, direction=, u=, "
                    "tendon=}, {sinks=, sources=, flipped=, still=, worst_turn=}  one entry per tet of the "
                    "part: its centre, the "
                    "unit direction of the fibers there, from origin to insertion, and the way u from 0 at "
                    "the origin to 1 at the "
                    "insertion. Then what was found of the field inside the muscle: places where u is "
                    "smallest or largest, tets with "
                    "directions more than 90 degrees apart, tets without a direction, the largest turn "
                    "within a tet in degrees. The "
                    "options give a curve to parts that have none (sinew.extract), or another one: as in "
                    "add_muscle, set_pennation "
                    "and set_frame"},
    {"part:fiber_lines",
     "part:fiber_lines{count=100, file=, ...} -> list of lines, each a list of points  through points spread "
     "evenly "
     "over the belly, from origin to insertion; file: .vtp or .obj; other options as part:fibers"},
    {"part:architecture", "part:architecture{...} -> {volume=, belly_volume=, tendon_volume=, fiber_length=, "
                          "pennation_angle=, pcsa=, "
                          "fiber_check=}  mean length of 400 fiber lines; mean angle between fibers and the "
                          "line of action in degrees; "
                          "physiological cross-section: belly_volume * cos(pennation_angle) / fiber_length; "
                          "options as part:fibers"},
    {"sinew.tets.load", "sinew.tets.load(path) -> tets | nil, message  reads .mesh .vtu .node + .ele"},
    {"tets:vertex_count", "t:vertex_count() -> number"},
    {"tets:tet_count", "t:tet_count() -> number"},
    {"tets:vertex", "t:vertex(i) -> point"},
    {"tets:tet", "t:tet(i) -> {a, b, c, d}  vertex indices"},
    {"tets:volume", "t:volume() -> number"},
    {"tets:bounds", "t:bounds() -> {min=, max=}"},
    {"tets:save", "t:save(path) -> true | nil, message  writes .vtu .mesh .msh"},
    {"tets:close", "t:close()  gives its memory back at once"},
    {"sinew.extract",
     "sinew.extract(tets, {{name=, values={...}}, ...} [, {margin=0.001}]) -> extraction  "
     "the regions where each function (one value per vertex) is the largest; the first takes "
     "the place of fat"},
};

static void add(lua_State *L, const help *h, size_t n)
{
    for (size_t i = 0; i < n; i++) {
        lua_pushstring(L, h[i].text);
        lua_setfield(L, -2, h[i].name);
    }
}

void lsn_open_help(lua_State *L)
{
    lua_newtable(L);
    add(L, general, sizeof general / sizeof *general);
    add(L, surfaces, sizeof surfaces / sizeof *surfaces);
    add(L, shapes, sizeof shapes / sizeof *shapes);
    add(L, scenes, sizeof scenes / sizeof *scenes);
    add(L, muscles, sizeof muscles / sizeof *muscles);
    add(L, results, sizeof results / sizeof *results);
    lua_setfield(L, -2, "help_text");
}
