/* srgb.h - between sRGB values and linear light. */
#ifndef SN_RENDER_SRGB_H
#define SN_RENDER_SRGB_H

#include <math.h>
#include <stdint.h>

static inline float sn_srgb_to_linear(float c)
{
    return c <= 0.04045f ? c / 12.92f : powf((c + 0.055f) / 1.055f, 2.4f);
}

static inline uint8_t sn_to_byte(float v) /* 0..1 to 0..255; what is outside is clamped, NaN gives 0 */
{
    if (!(v > 0.0f)) return 0;
    return v < 1.0f ? (uint8_t)(255.0f * v + 0.5f) : 255;
}

static inline uint8_t sn_linear_to_byte(float c)
{
    return sn_to_byte(c <= 0.0031308f ? 12.92f * c : 1.055f * powf(c, 1.0f / 2.4f) - 0.055f);
}

#endif
