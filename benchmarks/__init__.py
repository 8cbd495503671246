"""Speed of the filters, as ratios to peers that do the same work in the same run: ``python -m benchmarks``.

The work: one step of an extended Kalman filter with a measurement of six channels at every epoch, in Joseph form: nine
states (`benchmarks.models`), and 15 and 21 error states of a strapdown mechanisation (`benchmarks.systems`); and of an
unscented one with the same update, nine states. The peers: filterpy (`benchmarks.peers`) and the same algorithm in C
(`benchmarks/reference.c`, `benchmarks.reference`). Their states and covariances are compared with ours in the same run.
A time depends on the machine and its load, a ratio of minima over interleaved rounds hardly does: ratios are judged,
times stand beside them, and neither is a test.
"""
