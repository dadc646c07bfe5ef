/* muscle_color.c - a colour per muscle, by index only. */
#include "render/picture.h"

/* Chosen once, one after another: each the farthest in CIELAB from all before it (and twice as far from the
 * last four), among flesh-like reds, oranges, pinks and browns, later with some mauves, greens and blues of
 * low chroma. The first 40 are at least 12 apart. Ivory is left to the bones. */
static const unsigned char palette[][3] = {
    {175, 65, 55},   {245, 170, 75},  {245, 160, 195}, {125, 75, 95},   {170, 130, 90},  {250, 110, 100},
    {190, 105, 25},  {170, 35, 70},   {185, 120, 145}, {230, 175, 130}, {125, 80, 50},   {210, 95, 55},
    {255, 110, 135}, {160, 155, 215}, {150, 60, 100},  {65, 100, 55},   {140, 90, 20},   {255, 160, 150},
    {95, 180, 220},  {145, 65, 70},   {95, 85, 140},   {195, 135, 65},  {235, 125, 155}, {95, 185, 165},
    {165, 105, 90},  {155, 60, 20},   {255, 155, 100}, {215, 70, 90},   {30, 105, 140},  {145, 170, 115},
    {210, 140, 140}, {180, 100, 55},  {150, 90, 135},  {235, 170, 100}, {30, 115, 110},  {190, 85, 100},
    {245, 135, 110}, {140, 125, 155}, {145, 70, 40},   {230, 140, 60},  {190, 95, 130},  {220, 145, 115},
    {200, 160, 180}, {220, 100, 100}, {255, 155, 170}, {160, 95, 105},  {155, 100, 55},  {115, 145, 125}};
enum { n_palette = (int)(sizeof palette / sizeof palette[0]) };

/* Later rounds repeat the palette darker, then lighter, by a golden-ratio sequence so that no two rounds
 * agree. */
sn_rgb sn_muscle_color(int32_t i_muscle)
{
    const unsigned char *c = palette[i_muscle % n_palette];
    double u = 0.61803398874989485 * (i_muscle / n_palette);
    u -= (double)(int64_t)u;
    float to = u < 0.5 ? 255.0f : 0.0f, w = (float)(0.35 * (u < 0.5 ? u : 1.0 - u));
    if (i_muscle < n_palette) w = 0.0f;
    return (sn_rgb){((float)c[0] + w * (to - (float)c[0])) / 255.0f,
                    ((float)c[1] + w * (to - (float)c[1])) / 255.0f,
                    ((float)c[2] + w * (to - (float)c[2])) / 255.0f};
}
