"""Makes low_pass.csv: SciPy's zero-phase Butterworth, to hold ours against.

    pip install "scipy==1.17.1" "numpy==2.4.6"
    python low_pass.py > low_pass.csv
"""
import numpy as np
import scipy
from scipy.signal import butter, sosfiltfilt

CASES = [  # order, cutoff in Hz, sample rate in Hz
    (4, 5.0, 100.0),
    (4, 0.5, 100.0),
    (1, 3.0, 50.0),
    (2, 20.0, 100.0),
    (3, 40.0, 1000.0),
    (5, 2.0, 12.5),
    (8, 10.0, 100.0),
]

print(f"# scipy {scipy.__version__}, numpy {np.__version__}: sosfiltfilt(butter(order, cutoff, fs=rate, output='sos'), y)")
rng = np.random.default_rng(7)
k = np.arange(240)
y = 1e3 + np.abs(k - 97.0) * 0.4 - 20 * (k > 160) + rng.normal(0, 0.05, k.size)
y = np.round(y, 6)
columns = [sosfiltfilt(butter(order, cutoff, fs=rate, output="sos"), y) for order, cutoff, rate in CASES]
print("y," + ",".join(f"{order}/{cutoff}/{rate}" for order, cutoff, rate in CASES))
for row in zip(y, *columns):
    print(",".join(repr(float(value)) for value in row))
