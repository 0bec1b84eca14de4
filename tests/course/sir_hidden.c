/* The batch is SIR for many candidates at once, and one fallback of rejection is SIR. */
/* without: docs/extending.md src/beyond/blocks.c src/beyond/blocks.h src/beyond/product.c src/beyond/product.h */
/* [batch] */
/* Left out of this kit: sir takes its candidates one by one, by your code. */
bis_fast_needs bis_fast_needs_of(const bis_settings *s) { return (bis_fast_needs){.n_pool = bis_pool_needs(s)}; }

bis_status bis_fast_init(bis_fast *f, const bis_settings *s, bis_diag *diag)
{
    (void)s, (void)diag;
    *f = (bis_fast){.batch = NULL};
    return BIS_OK;
}

void bis_fast_clear(bis_fast *f) { *f = (bis_fast){.batch = NULL}; }

size_t bis_fast_bytes(const bis_settings *s)
{
    (void)s;
    return 0;
}

bis_Lo *bis_fast_Lo(const bis_settings *s) { return s->integrator->Lo; }

rgb bis_batch_Lo(const bis_settings *s, const bis_point *pt, bis_stream *stream, bis_scratch *scratch)
{
    return bis_sir.Lo(s, pt, stream, scratch);
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
