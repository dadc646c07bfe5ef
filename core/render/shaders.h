/* shaders.h - the GLSL 330 sources. Lists end with NULL and go to sn_gl_program. */
#ifndef SN_RENDER_SHADERS_H
#define SN_RENDER_SHADERS_H

extern const char *const sn_shader_muscle_vs[]; /* tets: in vec3 place (from the eye)                     */
extern const char *const sn_shader_muscle_fs[]; /* the first change from fat to muscle inside a tet       */
extern const char *const sn_shader_cut_vs[];    /* triangles of the domain's border or of the section     */
extern const char *const sn_shader_cut_fs[];    /* the tissue that wins at the point                      */
extern const char *const sn_shader_solid_vs[];  /* triangles: in vec3 place, in vec3 normal               */
extern const char *const sn_shader_solid_fs[];  /* bones and their caps                                   */
extern const char *const sn_shader_skin_fs[];   /* translucent, order-independent; after the solid vs     */
extern const char *const sn_shader_line_vs[];   /* tubes and balls: in vec3 centre, in vec3 direction     */
extern const char *const sn_shader_line_fs[];
extern const char *const sn_shader_fiber_vs[]; /* strips: in vec3 place, tangent, (side, tip, colour)     */
extern const char *const sn_shader_fiber_fs[]; /* among the solid things                                 */
extern const char *const sn_shader_fiber_line_fs[]; /* in the layer of the curves                          */
extern const char *const sn_shader_arrow_vs[]; /* in vec3 centre, normal, way out, (radius, colour, 0)     */
extern const char *const sn_shader_arrow_fs[];
extern const char *const sn_shader_screen_vs[]; /* one triangle over the tile                             */
extern const char *const sn_shader_occlusion_fs[];
extern const char *const sn_shader_final_fs[]; /* light, outlines, skin and curves into one picture      */
extern const char *const sn_shader_final_rest_fs[]; /* the same where nothing solid is                     */

#endif
