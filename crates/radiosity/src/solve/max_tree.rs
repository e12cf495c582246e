//! The largest and the sum of many changing numbers.

/// A complete binary tree whose nodes hold the maximum and the sum below them: changing a number costs `log n`, finding
/// the largest as much. The sum is always that of the numbers as they are, without drift.
#[derive(Debug, Clone)]
pub struct MaxTree {
    leaves: usize,
    values: Vec<f64>,
    sums: Vec<f64>,
}

impl MaxTree {
    /// A tree over these numbers.
    pub fn new(numbers: &[f64]) -> Self {
        let leaves = numbers.len().next_power_of_two().max(1);
        let mut tree = Self {
            leaves,
            values: vec![0.0; 2 * leaves],
            sums: Vec::new(),
        };
        tree.values[leaves..leaves + numbers.len()].copy_from_slice(numbers);
        tree.sums = tree.values.clone();
        for i in (1..leaves).rev() {
            tree.values[i] = tree.values[2 * i].max(tree.values[2 * i + 1]);
            tree.sums[i] = tree.sums[2 * i] + tree.sums[2 * i + 1];
        }
        tree
    }

    /// Changes a number.
    pub fn set(&mut self, index: usize, number: f64) {
        let mut i = self.leaves + index;
        self.values[i] = number;
        self.sums[i] = number;
        while i > 1 {
            i /= 2;
            self.values[i] = self.values[2 * i].max(self.values[2 * i + 1]);
            self.sums[i] = self.sums[2 * i] + self.sums[2 * i + 1];
        }
    }

    /// Changes many numbers at once: cheaper than one by one if they are a good part of all.
    pub fn set_many(&mut self, numbers: impl Iterator<Item = (usize, f64)>) {
        for (index, number) in numbers {
            self.values[self.leaves + index] = number;
            self.sums[self.leaves + index] = number;
        }
        for i in (1..self.leaves).rev() {
            self.values[i] = self.values[2 * i].max(self.values[2 * i + 1]);
            self.sums[i] = self.sums[2 * i] + self.sums[2 * i + 1];
        }
    }

    /// Sum of all numbers.
    pub fn sum(&self) -> f64 {
        self.sums[1.min(self.sums.len() - 1)]
    }

    /// A number.
    pub fn get(&self, index: usize) -> f64 {
        self.values[self.leaves + index]
    }

    /// Index of the largest number, the first of equal ones, and the number.
    pub fn largest(&self) -> (usize, f64) {
        let mut i = 1;
        while i < self.leaves {
            i = if self.values[2 * i] >= self.values[2 * i + 1] {
                2 * i
            } else {
                2 * i + 1
            };
        }
        (i - self.leaves, self.values[i])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn finds_the_largest_as_a_scan_does() {
        let mut numbers: Vec<f64> = (0..37_u32).map(|i| f64::from(i * 7919 % 101)).collect();
        let mut tree = MaxTree::new(&numbers);
        for step in 0..200_u32 {
            let i = (step * 31 % 37) as usize;
            numbers[i] = f64::from(step * 104_729 % 997);
            if step % 3 == 0 {
                tree.set_many([(i, numbers[i])].into_iter());
            } else {
                tree.set(i, numbers[i]);
            }
            let largest = numbers.iter().copied().fold(0.0, f64::max);
            let first = numbers.iter().position(|&n| n == largest).unwrap_or(0);
            assert_eq!(tree.largest(), (first, largest), "after step {step}");
            assert_eq!(tree.sum(), numbers.iter().sum::<f64>(), "after step {step}");
        }
    }
}
