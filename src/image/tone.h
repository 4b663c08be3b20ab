// Tone curves: from linear radiance to display values.
#ifndef LAMPYRIS_IMAGE_TONE_H
#define LAMPYRIS_IMAGE_TONE_H

enum tone_curve { TONE_NONE, TONE_REINHARD, TONE_ACES, TONE_AGX };

#endif
