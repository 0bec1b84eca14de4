/* SPDX-License-Identifier: BSD-2-Clause */
/* image_jpeg: the colours of a JPEG, for textures. Read by libjpeg, if bis is built with it (BIS_JPEG). Maps are never
 * read from it, because 8 bits of a screen are no radiance.
 *
 * libjpeg takes its memory by malloc, because it offers no other way. It leaves by longjmp on errors. What it only
 * warns of as damage (data that ends too early, codes that do not exist) is an error here, because it would fill the
 * rest with grey. But a file that lacks its last bytes alone, in the last row of blocks, is read, with a warning.
 * Four components are inks, C M Y K: of red, (1 - C) (1 - K) is left. Adobe's files hold 1 - C and so on (libjpeg.txt
 * of libjpeg, "Special color spaces").
 * What a header claims is held against the file: the coding spends at least one bit on 8 x 8 pixels. A progressive file
 * may visit all its blocks again and again: more than MOST_SCANS scans are refused. */
#include "image_io.h"

#include <string.h>

bool bis_jpeg_is_mine(const unsigned char *data, size_t size)
{
    return size >= 3 && memcmp(data, "\xff\xd8\xff", 3) == 0;
}

bool bis_image_reads_jpeg(void)
{
#ifdef BIS_JPEG
    return true;
#else
    return false;
#endif
}

#ifdef BIS_JPEG

#include "bis/base/mem.h"

#include <setjmp.h>
#include <stdio.h> /* before jpeglib.h, which uses FILE */

#include <jpeglib.h>
#include <jerror.h>

enum { MOST_SCANS = 200, PIXELS_OF_A_BYTE = 8 * 8 * 8 };

typedef struct jpeg_job {
    struct jpeg_decompress_struct jpeg;
    struct jpeg_error_mgr errors;
    struct jpeg_progress_mgr progress;
    jmp_buf leave;
    char reason[JMSG_LENGTH_MAX];
    bool out_of_memory;
    bool is_cut, lacks_rows; /* it ends before its end; before the last row of blocks */
    unsigned char *row;
} jpeg_job;

/* Of a file with several scans the last must be there, which leaves no bit of any coefficient open. */
static bool has_all_scans(const struct jpeg_decompress_struct *jpeg)
{
    if (jpeg->comps_in_scan < jpeg->num_components && !jpeg->progressive_mode) return false;
    for (int k = 0; jpeg->progressive_mode && k < jpeg->num_components * DCTSIZE2; k++)
        if (jpeg->coef_bits[k / DCTSIZE2][k % DCTSIZE2] != 0) return false;
    return true;
}

static void give_up(j_common_ptr jpeg)
{
    jpeg_job *job = jpeg->client_data;
    job->out_of_memory = jpeg->err->msg_code == JERR_OUT_OF_MEMORY;
    jpeg->err->format_message(jpeg, job->reason);
    longjmp(job->leave, 1);
}

/* Level -1 is a warning. Some only say that the writer was careless. */
static void on_message(j_common_ptr jpeg, int level)
{
    const int code = jpeg->err->msg_code;
    jpeg_job *job = jpeg->client_data;
    job->is_cut |= level < 0 && code == JWRN_JPEG_EOF;
    if (job->is_cut && code == JWRN_HIT_MARKER)
        job->lacks_rows |= job->jpeg.input_iMCU_row + 1 < job->jpeg.total_iMCU_rows;
    if (job->is_cut && (code == JWRN_JPEG_EOF || code == JWRN_HIT_MARKER)) return; /* judged with the rows */
    if (level >= 0 || code == JWRN_EXTRANEOUS_DATA || code == JWRN_JFIF_MAJOR || code == JWRN_ADOBE_XFORM) return;
    give_up(jpeg);
}

static void on_progress(j_common_ptr jpeg)
{
    jpeg_job *job = jpeg->client_data;
    if (job->jpeg.input_scan_number <= MOST_SCANS) return;
    snprintf(job->reason, sizeof job->reason, "it has more than %d scans", MOST_SCANS);
    longjmp(job->leave, 1);
}

static bis_status refuse(const jpeg_job *job, const image_input *in)
{
    if (job->out_of_memory) return bis_image_refuse(in, BIS_NOMEM, "no memory for the picture");
    return bis_image_refuse(in, BIS_INPUT, "the JPEG is damaged, or of a kind that is not read: %s", job->reason);
}

/* False: libjpeg has left. */
static bool read_header(jpeg_job *job, const image_input *in)
{
    if (setjmp(job->leave)) return false;
    jpeg_mem_src(&job->jpeg, in->data, (unsigned long)in->size);
    jpeg_read_header(&job->jpeg, TRUE);
    job->jpeg.out_color_space = job->jpeg.num_components == 4 ? JCS_CMYK : JCS_RGB;
    job->jpeg.dct_method = JDCT_ISLOW;
    return true;
}

/* Inks to the light that they let pass. */
static void mix_inks(jpeg_job *job, int width)
{
    const int flip = job->jpeg.saw_Adobe_marker ? 0 : 255;
    for (int x = 0; x < width; x++) {
        const unsigned char *ink = job->row + 4 * (size_t)x;
        const int k = ink[3] ^ flip;
        for (int i = 0; i < 3; i++) job->row[3 * x + i] = (unsigned char)(((ink[i] ^ flip) * k + 127) / 255);
    }
}

static bool judge_cut(jpeg_job *job)
{
    if (!job->lacks_rows && (!job->is_cut || has_all_scans(&job->jpeg))) return true;
    snprintf(job->reason, sizeof job->reason, "the file is cut off");
    return false;
}

static bool read_rows(jpeg_job *job, bis_image *image, const float *table)
{
    if (setjmp(job->leave)) return false;
    jpeg_start_decompress(&job->jpeg);
    while (job->jpeg.output_scanline < job->jpeg.output_height) {
        rgb *to = image->pixels + (size_t)job->jpeg.output_scanline * (size_t)image->width;
        jpeg_read_scanlines(&job->jpeg, &job->row, 1);
        if (!judge_cut(job)) return false;
        if (job->jpeg.out_color_components == 4) mix_inks(job, image->width);
        for (int x = 0; x < image->width; x++) {
            const unsigned char *c = job->row + 3 * (size_t)x;
            to[x] = (rgb){table[c[0]], table[c[1]], table[c[2]]};
        }
    }
    jpeg_finish_decompress(&job->jpeg);
    return true;
}

static bis_status make_image(bis_image *image, jpeg_job *job, const image_input *in)
{
    const unsigned width = job->jpeg.image_width, height = job->jpeg.image_height;
    if ((double)width * height > (double)PIXELS_OF_A_BYTE * (double)in->size)
        return bis_image_refuse(in, BIS_INPUT, "%zu bytes cannot hold %u x %u pixels", in->size, width, height);
    const bis_status status = bis_image_make(image, in, width, height);
    if (status) return status;
    job->row = bis_alloc(width, 4);
    return job->row ? BIS_OK : bis_image_refuse(in, BIS_NOMEM, "no memory for its rows");
}

bis_status bis_jpeg_read(bis_image *image, const image_input *in, double gamma)
{
    jpeg_job job = {.row = NULL};
    float *table = NULL;
    bis_status status;

    job.jpeg.err = jpeg_std_error(&job.errors);
    job.errors.error_exit = give_up;
    job.errors.emit_message = on_message;
    job.jpeg.client_data = &job;
    if (setjmp(job.leave)) return refuse(&job, in); /* nothing is made yet */
    jpeg_create_decompress(&job.jpeg);
    job.progress.progress_monitor = on_progress;
    job.jpeg.progress = &job.progress;
    status = read_header(&job, in) ? make_image(image, &job, in) : refuse(&job, in);
    if (!status) status = bis_image_table(&table, 8, gamma == BIS_GAMMA_FILE ? BIS_GAMMA_SRGB : gamma, in);
    if (!status && !read_rows(&job, image, table)) status = refuse(&job, in);
    if (!status && job.is_cut)
        bis_image_remark(in, "the JPEG ends too early: in the last %d rows colours may be made up",
                         job.jpeg.max_v_samp_factor * DCTSIZE);
    if (!status && job.jpeg.num_components == 4)
        bis_image_remark(in, "its inks C M Y K become red, green and blue without a colour profile: colours are near");
    jpeg_destroy_decompress(&job.jpeg);
    if (status) bis_image_clear(image);
    bis_free(job.row);
    bis_free(table);
    return status;
}

#else

bis_status bis_jpeg_read(bis_image *image, const image_input *in, double gamma)
{
    (void)image;
    (void)gamma;
    return bis_image_refuse(in, BIS_INPUT, "it is a JPEG, and this bis is built without libjpeg: install libjpeg-dev "
                            "and build again, or save the picture as .png");
}

#endif
