"""What first order says of built rigs: tolerances that would do, and yields to be expected."""
