/* The batch is SIR for many candidates at once, and one fallback of rejection is SIR. */
/* without: docs/extending.md src/beyond/blocks.c src/beyond/blocks.h src/beyond/product.c src/beyond/product.h */
/* [batch] */
/* Left out of this kit: sir takes its candidates one by one, by your code. */
bool bis_batch_wanted(const bis_settings *s)
{
    (void)s;
    return false;
}

bis_batch *bis_batch_new(const bis_settings *s)
{
    (void)s;
    return NULL;
}

void bis_batch_free(bis_batch *b) { (void)b; }

size_t bis_batch_bytes(const bis_settings *s)
{
    (void)s;
    return 0;
}

bool bis_batch_fits(const bis_point *pt, const bis_scratch *scratch)
{
    (void)pt, (void)scratch;
    return false;
}

rgb bis_batch_Lo(const bis_settings *s, const bis_point *pt, bis_stream *stream, bis_scratch *scratch)
{
    (void)s, (void)pt, (void)stream, (void)scratch;
    return (rgb){0, 0, 0};
}
/* [end] */
    /* [fall-back-resample] */
    /* BIS_FALLBACK_RESAMPLE and BIS_FALLBACK_SUBSET are left out of this kit. */
    (void)Zhat;
    /* [end] */
    /* [fall-back-subset] */
    uint32_t A = positive(scratch->chosen, x, M), n = A < N ? A : N;
    draw_without_replacement(scratch->chosen, A, n, stream);
    return bis_candidates_unoccluded(x, M);
    /* [end] */
